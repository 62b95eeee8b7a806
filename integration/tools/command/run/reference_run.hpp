#pragma once
// The CPU truth at many pixels, with progress and a way to stop.

#include "integration/tools/command/session.hpp"
#include "integration/tools/files/metrics.hpp"
#include "passes/common/reference/reference.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// 3 doubles for each of `pixels`, in their order; nullopt when interrupted.
std::optional<std::vector<double>> run_reference(const Session& session, const std::string& what,
                                                 const subsurface::ReferenceInput& input,
                                                 std::span<const uint32_t> pixels);

// Median over pixels with a profile of the widest channel's d, projected, in pixels (`d_px`). 0 for none.
double median_d_px(const subsurface::ReferenceInput& input);

// Pixels with a profile.
uint64_t subsurface_pixels(std::span<const uint8_t> profile);

// An error figure as a table and as JSON; `where` says what was measured ("frame 7").
std::string format_error(const ErrorFigures& figures, const std::string& where, uint64_t population,
                         double exposure, double d_px);
std::string error_as_json(const ErrorFigures& figures, uint64_t population, double exposure, double d_px);

} // namespace dermis::tools
