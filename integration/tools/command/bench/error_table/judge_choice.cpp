#include "integration/tools/command/bench/error_table/judge_choice.hpp"

#include "passes/choice/error_correction.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

namespace dermis::tools {
namespace {

constexpr int frames = 600;
constexpr double frame_s = 1.0 / 60;
constexpr int probe_interval = 4;       // frames; the default of skin.json
constexpr double worth_a_switch = 0.95; // of the error of the technique that runs

// A technique on a scene.
struct Option {
  int32_t row = -1;
  double expected = 0, measured = 0; // RMSE
};

struct Scene {
  choice::FrameKey key;
  double unscattered = 0, expected_unscattered = 0; // RMSE
  std::vector<Option> options;
};

std::vector<Scene> scenes_of(const choice::ErrorModel& table, std::span<const MeasuredError> errors,
                             std::span<const std::string> techniques, const std::string& half) {
  std::map<std::tuple<std::string, double>, Scene> scenes;
  for (const MeasuredError& error : errors) {
    if (error.half == half && error.technique == "off") {
      Scene& scene = scenes[{error.scene, error.d_px}];
      scene.unscattered = error.rmse;
      scene.expected_unscattered = expected_rmse(table, -1, {error.d_px, error.relief});
    }
    if (error.half != half || std::ranges::find(techniques, error.technique) == techniques.end())
      continue;
    const auto row =
        std::ranges::find(table.techniques, error.technique, &choice::TechniqueError::name);
    if (row == table.techniques.end()) continue;
    Scene& scene = scenes[{error.scene, error.d_px}];
    scene.key = {error.d_px, error.relief};
    const auto index = static_cast<int32_t>(row - table.techniques.begin());
    scene.options.push_back({index, expected_rmse(table, index, scene.key), error.rmse});
  }
  std::vector<Scene> complete;
  for (auto& [name, scene] : scenes)
    if (scene.options.size() == techniques.size() && scene.unscattered > 0)
      complete.push_back(std::move(scene));
  return complete;
}

template <class Error> const Option& best_of(const Scene& scene, Error error) {
  return *std::ranges::min_element(scene.options, {}, error);
}

// `choose(scene, switches)` returns the measured RMSE of the choice.
template <class Choose> ChoiceError judge(const std::vector<Scene>& scenes, Choose choose) {
  ChoiceError out;
  double logs = 0;
  for (const Scene& scene : scenes) {
    const double ratio = choose(scene, out.switches) / best_of(scene, &Option::measured).measured;
    logs += std::log(ratio);
    out.worst = std::max(out.worst, ratio);
  }
  out.scenes = scenes.size();
  if (scenes.empty()) return out;
  out.mean = std::exp(logs / double(scenes.size()));
  out.switches /= double(scenes.size());
  return out;
}

// Returns the geometric mean over the second half of the frames.
double choose_by_measurements(const Scene& scene, const choice::ErrorModel& table,
                              double& switches) {
  choice::ErrorCorrection correction = make_error_correction(table);
  const auto compared = std::ranges::find(scene.options, correction.compared, &Option::row);
  const bool compares = compared != scene.options.end();
  if (!compares) correction.compared = -1; // not among the techniques
  const Option* running = &best_of(scene, &Option::expected);
  double now_s = 0, logs = 0;
  for (int i = 0; i < frames; ++i, now_s += frame_s) {
    const auto corrected = [&](const Option& one) {
      return one.expected * error_factor(correction, one.row, scene.key, now_s);
    };
    const Option& best = best_of(scene, corrected);
    if (corrected(best) < worth_a_switch * corrected(*running)) {
      running = &best;
      ++switches;
    }
    if (i % probe_interval == 0)
      observe_error(correction, {running->row, running->measured * running->measured,
                                 scene.unscattered * scene.unscattered, running->expected,
                                 scene.expected_unscattered, scene.key, now_s,
                                 compares ? compared->measured * compared->measured : 0,
                                 compares ? compared->expected : 0});
    if (i >= frames / 2) logs += std::log(running->measured) / (frames - frames / 2);
  }
  return std::exp(logs);
}

} // namespace

ChoiceError judge_choice(const choice::ErrorModel& table, std::span<const MeasuredError> errors,
                         std::span<const std::string> techniques, const std::string& half) {
  return judge(scenes_of(table, errors, techniques, half), [](const Scene& scene, double&) {
    return best_of(scene, &Option::expected).measured;
  });
}

ChoiceError judge_measuring_choice(const choice::ErrorModel& table,
                                   std::span<const MeasuredError> errors,
                                   std::span<const std::string> techniques,
                                   const std::string& half) {
  return judge(scenes_of(table, errors, techniques, half),
               [&](const Scene& scene, double& switches) {
                 return choose_by_measurements(scene, table, switches);
               });
}

} // namespace dermis::tools
