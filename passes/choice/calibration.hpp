#pragma once
// Costs as a JSON file: what `dermis calibrate` writes for a device and a host gives back at the next start.

#include "framegraph/text/document.hpp"
#include "passes/choice/cost_model.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::choice {

struct Calibration {
  std::string device; // name, for people
  std::vector<Cost> costs;
};

// Reads `"dermis_calibration": 2`. nullopt with errors in `diagnostics`. Thread: any.
std::optional<Calibration> read_calibration(const Document& document, Diagnostics& diagnostics);
// The same costs give the same bytes.
std::string write_calibration(const Calibration& calibration);

} // namespace dermis::choice
