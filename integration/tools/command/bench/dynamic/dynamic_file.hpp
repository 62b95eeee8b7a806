#pragma once
// What `dermis bench dynamic` measures, as data: tests/benchmark/dynamic.json.

#include "integration/tools/command/bench/dynamic/sequence.hpp"
#include "integration/tools/command/bench/plan_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct DynamicTechnique {
  TechniqueRequest request;
  std::string guidance;     // "none": as many samples everywhere, or none
  uint32_t min_samples = 0; // a pixel, where it is sampled
};

struct DynamicFile {
  uint32_t counted = 25;  // the first frame of a sequence that counts
  uint32_t subset = 1024; // pixels of a frame that have a truth
  std::vector<SequenceRequest> scenes;
  std::vector<DynamicTechnique> techniques;
};

// nullopt with located errors.
std::optional<DynamicFile> read_dynamic(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
