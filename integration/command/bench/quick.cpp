#include "integration/command/bench/quick.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

constexpr Size small{96, 54};
constexpr uint32_t few_pixels = 64;    // that have a truth, of a frame
constexpr uint32_t more_frames = 2;    // of a sequence, beyond those for histories to begin
constexpr uint32_t few_judged = 4;     // frames of a budget
constexpr uint64_t few_updates = 1000; // of values in half floats

} // namespace

BenchErrorTimeOptions quickened(BenchErrorTimeOptions options) {
  if (options.quick) options.size = small;
  return options;
}

BenchDynamicOptions quickened(BenchDynamicOptions options) {
  if (options.quick) options.size = small;
  return options;
}

BenchStabilityOptions quickened(BenchStabilityOptions options) {
  if (options.quick) options.updates = few_updates;
  return options;
}

BenchBudgetOptions quickened(BenchBudgetOptions options) {
  if (!options.quick) return options;
  options.size = small;
  options.frames = few_judged;
  return options;
}

BenchSkipOptions quickened(BenchSkipOptions options) {
  if (!options.quick) return options;
  options.size = small;
  options.repetitions = 1;
  return options;
}

void quicken(ErrorTimeFile& file) {
  file.repetitions = file.warm_up = file.least_repetitions = 1;
  file.subset = std::min(file.subset, few_pixels);
  file.self_scenes.clear();
}

void quicken(DynamicFile& file) {
  file.counted = std::min(file.counted, more_frames);
  file.subset = std::min(file.subset, few_pixels);
  for (SequenceRequest& scene : file.scenes)
    scene.frames = std::min(scene.frames, file.counted + more_frames);
}

std::pair<std::string, std::string> quick_fact() {
  return {"quick", "small pictures, few repetitions: to see that everything runs; the figures say nothing"};
}

} // namespace dermis::tools
