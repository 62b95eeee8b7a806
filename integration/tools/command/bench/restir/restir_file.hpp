#pragma once
// What `dermis bench restir` measures, as data: tests/benchmark/restir.json.

#include "integration/tools/command/bench/plan_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct RayReferenceSize { // of a pixel
  uint32_t samples = 64, frames = 32;
};

struct RestirFile {
  std::string graph;             // scatters by rays; its settings reuse and shift say what is measured
  std::vector<uint32_t> samples; // paths a pixel and frame; a row each
  uint32_t settle = 24;          // frames before the counted ones where there is history
  uint32_t frames = 24;          // counted
  uint32_t repetitions = 5;      // timed runs of what does not change from frame to frame
  double thin_mm = 6;            // light from behind comes through parts up to so thick
  RayReferenceSize reference;
  std::vector<SceneRequest> scenes;
  std::vector<TechniqueRequest> screen_space; // beside it
};

// nullopt with located errors.
std::optional<RestirFile> read_restir(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
