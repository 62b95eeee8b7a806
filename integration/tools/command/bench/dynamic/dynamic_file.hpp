#pragma once
// Contents of tests/benchmark/dynamic.json, which describes `dermis bench dynamic`.

#include "integration/tools/command/bench/dynamic/sequence.hpp"
#include "integration/tools/command/bench/suite/bench_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct DynamicTechnique : TechniqueRequest {
  std::string guidance;     // "none": a constant number of samples, possibly 0
  uint32_t min_samples = 0; // per sampled pixel
};

struct DynamicFile {
  uint32_t counted = 25;  // first counted frame of a sequence
  uint32_t subset = 1024; // pixels per frame with a reference
  std::vector<SequenceRequest> scenes;
  std::vector<DynamicTechnique> techniques;
};

// Returns nullopt with located errors.
std::optional<DynamicFile> read_dynamic(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
