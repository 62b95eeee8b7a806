#pragma once
// Contents of tests/benchmark/restir.json, which describes `dermis bench restir`.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/bench/suite/bench_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct RayReferenceSize { // per pixel
  uint32_t samples = 64, frames = 32;
};

struct RestirFile {
  // scatters by rays; its settings reuse and shift define the variants
  std::string graph;
  std::vector<uint32_t> samples; // paths per pixel and frame; one row each
  uint32_t settle = 24;          // frames before the counted frames, for variants with history
  uint32_t frames = 24;          // counted
  uint32_t repetitions = 5;      // timed runs of variants without history
  double thin_mm = 6;            // thickness up to which back light is transmitted
  RayReferenceSize reference;
  std::vector<SceneRequest> scenes;
  std::vector<TechniqueRequest> screen_space; // techniques for comparison
};

// Returns nullopt with located errors.
std::optional<RestirFile> read_restir(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
