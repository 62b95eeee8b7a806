#include "integration/tools/command/bench/quick.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

namespace dermis::tools {
namespace {

constexpr Size small{96, 54};
constexpr uint32_t few_pixels = 64; // per frame, with a reference
constexpr uint32_t more_frames = 2; // of a sequence, after those in which histories start
constexpr uint32_t few_judged = 4;  // frames of a budget
constexpr Size few_rays{32, 32};
constexpr RayReferenceSize rough_reference{16, 4};
constexpr uint64_t few_updates = 1000; // of moving values in half floats
// One technique of each kind.
constexpr std::string_view few_techniques[] = {"sap", "sap_residual", "burley", "afis_guided", "separable"};

bool is_of_few(std::string_view technique) {
  return std::find(std::begin(few_techniques), std::end(few_techniques), technique) !=
         std::end(few_techniques);
}

// Keeps the first setting of each of these techniques; `name` returns an entry's technique.
template <class Technique, class Name> void keep_few(std::vector<Technique>& all, Name name) {
  std::vector<Technique> few;
  for (Technique& one : all)
    if (is_of_few(name(one)) && std::none_of(few.begin(), few.end(), [&](const Technique& other) {
          return name(other) == name(one);
        }))
      few.push_back(std::move(one));
  all = std::move(few);
}

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
  options.repetitions = 1;
  options.scenes = {"flashing", "dolly"}; // changing light, and changing size
  return options;
}

BenchSkipOptions quickened(BenchSkipOptions options) {
  if (!options.quick) return options;
  options.size = small;
  options.repetitions = 1;
  return options;
}

BenchRestirOptions quickened(BenchRestirOptions options) {
  if (options.quick) options.size = few_rays;
  return options;
}

void quicken(ErrorTimeFile& file) {
  file.repetitions = file.warm_up = file.min_repetitions = 1;
  file.subset = std::min(file.subset, few_pixels);
  file.self_scenes.clear();
}

void quicken(DynamicFile& file) {
  file.counted = std::min(file.counted, more_frames);
  file.subset = std::min(file.subset, few_pixels);
  for (SequenceRequest& scene : file.scenes)
    scene.frames = std::min(scene.frames, file.counted + more_frames);
}

void quicken(RestirFile& file) {
  file.settle = file.frames = more_frames;
  file.repetitions = 1;
  file.reference = rough_reference;
  file.samples.resize(1);
  file.scenes.resize(1);
}

void quicken(PropertyFile& file) {
  keep_few(file.techniques, [](const PropertyTechnique& one) { return one.request.technique; });
}

void quicken(std::vector<TechniqueRequest>& techniques) {
  keep_few(techniques, [](const TechniqueRequest& one) { return one.technique; });
}

std::pair<std::string, std::string> quick_fact() {
  return {
      "quick",
      "a smoke test with small images and few repetitions, scenes or techniques; figures are meaningless"};
}

} // namespace dermis::tools
