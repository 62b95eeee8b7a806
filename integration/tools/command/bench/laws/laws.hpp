#pragma once
// Laws of scattering with a known answer, measured: formulas, the fp64 truth, and every technique on the
// device.

#include "integration/tools/command/bench/technique.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct LawRow {
  std::string law, technique; // technique: "formula", "truth", or "sap smooth"
  double expected = 0, measured = 0;
  std::optional<double> tolerance; // of the absolute difference; nullopt: reported, not gated

  bool holds() const;
};

// Values of the closed forms and of the sampler against the tabulated or exact ones.
std::vector<LawRow> formula_laws();

// What scatters a frame: 3 values a pixel.
using Scatter = std::function<demo::Result<std::vector<float>>(const CapturedFrame&)>;

// A technique that laws are asked of, with the tolerance of each law by name; laws it does not name are
// reported.
struct LawSubject {
  std::string name;
  Scatter scatter;
  std::vector<std::pair<std::string, double>> tolerances;
};

// The size of every frame that plane_laws asks for, pixels.
inline constexpr uint32_t law_width = 512, law_height = 192;
// The band around the middle row, and all columns: what plane_laws looks at in frames that are no planes.
bool is_looked_at(uint32_t x, uint32_t y);
// The profiles that its frames use.
std::vector<CaptureProfile> law_profiles();

// Names of the laws that plane_laws measures, for tolerances.
std::vector<std::string_view> plane_law_names();

// Laws of planes and steps. Errors: those of `scatter`.
demo::Result<std::vector<LawRow>> plane_laws(const LawSubject& subject);

} // namespace dermis::tools
