#pragma once
// The truth of frames that differ in how bright their lights are and in nothing else: it is as linear in
// light as scattering is, so a few truths serve all frames.

#include "integration/tools/command/bench/reference.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace dermis::tools {

// Truths of frames of one scene whose camera and surfaces rest. Grows by a frame that is no sum of earlier
// ones, until it holds max_known_references.
struct KnownReferences {
  struct Known {
    std::vector<float> light;      // orthonormal to the others, over pixels with a profile
    std::vector<double> reference; // of that light, 3 a pixel of `pixels`
  };
  std::vector<Known> known;
  Reference first; // pixels and their number are those of all frames
};
inline constexpr size_t max_known_references = 8;

// As make_reference; `known` may be empty at first and must be of the same scene.
std::optional<Reference> make_reference_of_still(const Session& session, const CapturedFrame& frame,
                                                 const std::string& what, uint32_t subset,
                                                 const std::string& cache, KnownReferences& known);

} // namespace dermis::tools
