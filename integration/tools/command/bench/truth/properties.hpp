#pragma once
// Measures properties of scattering with known results: for formulas, the fp64 reference, and every
// technique on the device.

#include "integration/tools/command/bench/technique.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct PropertyRow {
  std::string property, technique; // technique: "formula", "truth", or "sap smooth"
  double expected = 0, measured = 0;
  std::optional<double> tolerance; // of the absolute difference; nullopt: reported, but not gated

  bool holds() const;
};

// Compares closed forms and the sampler with tabulated or exact values.
std::vector<PropertyRow> formula_properties();

// Scatters a frame; returns 3 values per pixel.
using Scatter = std::function<demo::Result<std::vector<float>>(const CapturedFrame&)>;

// A technique under test, with tolerances by property name. Properties without a tolerance are only
// reported.
struct PropertySubject {
  std::string name;
  Scatter scatter;
  std::vector<std::pair<std::string, double>> tolerances;
};

// Size of every frame of plane_properties, pixels.
inline constexpr uint32_t property_width = 512, property_height = 192;
// Returns whether plane_properties evaluates the pixel in frames that are not planes: a band around
// the middle row.
bool is_looked_at(uint32_t x, uint32_t y);
// Returns the profiles of the frames.
std::vector<CaptureProfile> property_profiles();

// Returns the names of the properties, for tolerances.
std::vector<std::string_view> plane_property_names();

// Measures the properties of planes and steps. Errors: those of `scatter`.
demo::Result<std::vector<PropertyRow>> plane_properties(const PropertySubject& subject);

} // namespace dermis::tools
