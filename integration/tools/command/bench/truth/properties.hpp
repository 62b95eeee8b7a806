#pragma once
// Laws of scattering with a known answer, measured: formulas, the fp64 truth, and every technique on the
// device.

#include "integration/tools/command/bench/technique.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct PropertyRow {
  std::string property, technique; // technique: "formula", "truth", or "sap smooth"
  double expected = 0, measured = 0;
  std::optional<double> tolerance; // of the absolute difference; nullopt: reported, not gated

  bool holds() const;
};

// Values of the closed forms and of the sampler against the tabulated or exact ones.
std::vector<PropertyRow> formula_properties();

// What scatters a frame: 3 values a pixel.
using Scatter = std::function<demo::Result<std::vector<float>>(const CapturedFrame&)>;

// A technique that laws are asked of, with the tolerance of each law by name; laws it does not name are
// reported.
struct PropertySubject {
  std::string name;
  Scatter scatter;
  std::vector<std::pair<std::string, double>> tolerances;
};

// The size of every frame that plane_properties asks for, pixels.
inline constexpr uint32_t property_width = 512, property_height = 192;
// The band around the middle row, and all columns: what plane_properties looks at in frames that are no
// planes.
bool is_looked_at(uint32_t x, uint32_t y);
// The profiles that its frames use.
std::vector<CaptureProfile> property_profiles();

// Names of the laws that plane_properties measures, for tolerances.
std::vector<std::string_view> plane_property_names();

// Laws of planes and steps. Errors: those of `scatter`.
demo::Result<std::vector<PropertyRow>> plane_properties(const PropertySubject& subject);

} // namespace dermis::tools
