#pragma once
// References of still frames, computed once and cached in files shared by the benches.

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
  // computed pixels, ascending: all with a profile, or a stratified subset
  std::vector<uint32_t> pixels;
  std::vector<double> light; // 3 values per pixel of `pixels`
  uint64_t population = 0;   // pixels with a profile
  double exposure = 1;       // of the scene: maps the 99.9th percentile of the reference to 1
  bool everywhere = false;   // `pixels` holds all pixels with a profile
};

// Convolves planes that face an orthographic camera everywhere; computes other frames at `subset`
// pixels (0: all). `cache` is a folder for results by a hash of all inputs; "" disables the cache.
// Invalid cached files are recomputed. Returns nullopt if interrupted.
std::optional<Reference> make_reference(const Session& session, const CapturedFrame& frame,
                                        const std::string& what, uint32_t subset,
                                        const std::string& cache);

} // namespace dermis::tools
