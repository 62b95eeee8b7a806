#pragma once
// Computes the CPU reference at many pixels, with progress and interruption.

#include "integration/tools/command/session.hpp"
#include "integration/tools/files/metrics.hpp"
#include "passes/common/reference/reference.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Returns 3 doubles for each of `pixels`, in order, or nullopt if interrupted.
std::optional<std::vector<double>> run_reference(const Session& session, const std::string& what,
                                                 const subsurface::ReferenceInput& input,
                                                 std::span<const uint32_t> pixels);

// Returns the median over pixels with a profile of the widest channel's projected d (`d_px`),
// pixels. Returns 0 if there are none.
double median_d_px(const subsurface::ReferenceInput& input);

// Counts pixels with a profile.
uint64_t subsurface_pixels(std::span<const uint8_t> profile);

// Format an error figure as a table and as JSON; `where` names the measured frame ("frame 7").
std::string format_error(const ErrorFigures& figures, const std::string& where, uint64_t population,
                         double exposure, double d_px);
std::string error_as_json(const ErrorFigures& figures, uint64_t population, double exposure,
                          double d_px);

} // namespace dermis::tools
