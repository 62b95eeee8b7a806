#pragma once
// Counts the image reads of one invocation of each kernel, as written in its source (shaders/).
// Benches use the counts to compare techniques independently of one machine's timings.

#include "framegraph/model/pass_type.hpp"
#include "passes/common/reference/pixel_kernel.hpp"

#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace dermis::subsurface {

// One pass of a plan, and the surface that the pass works on.
struct ReadsInput {
  std::span<const SettingValue> settings; // resolved, one per PassTypeSetting
  std::vector<bool> bound;                // one per port of the pass type
  PerChannel d_px{};                      // projected d, pixels
  // make_shared_sap_tables({true, true}); only read by pass types of the pyramid
  std::span<const float> sap_tables;
  // Fraction of the pixels that take samples in this frame, for pass types that do not sample
  // everywhere.
  double sampled_fraction = 1;
  double subsurface_fraction = 1; // fraction of the view's pixels with subsurface
  // fraction of the view's pixels in tiles that scatter beyond a pixel
  double scattering_fraction = 1;
};

struct ImageReads {
  double per_invocation = 0; // texels read by an invocation whose whole neighbourhood is subsurface
  double samples = 0;        // those of the texels at random positions (stochastic samples)
};

// Returns the texels that an invocation reads; nullopt for other pass types than those of
// pass_types_with_known_reads(). Counts reads that the kernel skips where a neighbour has another
// profile, no depth, or is outside the image; branches on the scattering distance are those of
// `input`. Callable from any thread.
std::optional<ImageReads> image_reads(const PassType& type, const ReadsInput& input);

// Returns the pass types with known reads.
std::vector<std::string_view> pass_types_with_known_reads();

} // namespace dermis::subsurface
