#pragma once
// Costs as a JSON file, which `dermis calibrate` writes for a device and a host loads at its next
// start.

#include "framegraph/text/document.hpp"
#include "passes/choice/cost_estimator.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::choice {

struct Calibration {
  std::string device; // human-readable name
  // factor >= 1 by which times may be wrong on the device that uses them; costs may state their own
  double uncertainty = other_device_uncertainty;
  std::vector<Cost> costs;
};

// Reads `"dermis_calibration": 2`. Returns nullopt with errors in `diagnostics`. Thread: any.
std::optional<Calibration> read_calibration(const Document& document, Diagnostics& diagnostics);
// Returns the JSON text. Equal costs give equal bytes.
std::string write_calibration(const Calibration& calibration);

} // namespace dermis::choice
