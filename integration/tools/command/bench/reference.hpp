#pragma once
// The truth of still frames, computed once and kept in files, so that benches share it.

#include "integration/tools/command/session.hpp"
#include "integration/tools/files/capture.hpp"
#include "integration/tools/files/metrics.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct Reference {
  std::vector<uint32_t> pixels; // that were computed, ascending: all with a profile, or a stratified subset
  std::vector<double> light;    // 3 a pixel of `pixels`
  uint64_t population = 0;      // pixels with a profile
  double exposure = 1;          // the scene's: 99.9th percentile of B at 1
  bool everywhere = false;      // `pixels` are all with a profile
};

// Planes that face an orthographic camera are convolved everywhere, other frames at `subset` pixels (0: all).
// `cache` names a folder for results, by a hash of everything that the truth depends on; "": none. A cached
// file that is not what it should be is computed anew. nullopt when interrupted.
std::optional<Reference> make_reference(const Session& session, const CapturedFrame& frame,
                                        const std::string& what, uint32_t subset, const std::string& cache);

} // namespace dermis::tools
