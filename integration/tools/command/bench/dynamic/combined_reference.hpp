#pragma once
// References of frames that differ only in the brightness of their lights. References are linear in
// light, so a few references serve all frames.

#include "integration/tools/command/bench/reference.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace dermis::tools {

// References of frames of one scene with resting camera and surfaces. Grows by each frame that is
// not a sum of earlier ones, up to max_known_references.
struct KnownReferences {
  struct Known {
    std::vector<float> light;      // orthonormal to the other entries, over pixels with a profile
    std::vector<double> reference; // of that light, 3 values per pixel of `pixels`
  };
  std::vector<Known> known;
  Reference first; // its pixels and population apply to all frames
};
inline constexpr size_t max_known_references = 8;

// As make_reference. `known` starts empty and must belong to the same scene.
std::optional<Reference> make_reference_of_still(const Session& session, const CapturedFrame& frame,
                                                 const std::string& what, uint32_t subset,
                                                 const std::string& cache, KnownReferences& known);

} // namespace dermis::tools
