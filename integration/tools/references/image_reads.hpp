#pragma once
// How many image reads one invocation of each kernel makes, counted in its source (shaders/): for benches
// that compare techniques by more than one machine's clock.

#include "framegraph/model/pass_type.hpp"
#include "passes/common/reference/pixel_kernel.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace dermis::subsurface {

// One pass of a plan, and the surface it works on.
struct ReadsQuestion {
  std::span<const SettingValue> settings; // resolved, one per PassTypeSetting
  std::vector<bool> bound;                // one per port of the pass type
  PerChannel d_px{};                      // projected d
  std::span<const float>
      sap_tables; // make_sap_tables({true, true}, {}); only kinds of the pyramid look at them
  double sampled_fraction =
      1; // of the pixels, those that take samples in this frame, where a pass type does not in all
  double subsurface_fraction = 1; // of the pixels of the view, those with subsurface,
  double scattering_fraction = 1; // and those in tiles that scatter further than a pixel
};

struct ImageReads {
  double per_invocation = 0; // texels fetched by an invocation whose surroundings all are subsurface
  double samples = 0;        // of these taps, those whose place a random number chose: stochastic samples
};

// nullopt for a pass type that is not in the list. Reads that a kernel skips where another profile, no depth
// or the border is are counted as made; branches on d are followed. Thread: any.
std::optional<ImageReads> image_reads(const PassType& type, const ReadsQuestion& question);

// Kinds whose reads are known.
std::vector<std::string_view> pass_types_with_known_reads();

} // namespace dermis::subsurface
