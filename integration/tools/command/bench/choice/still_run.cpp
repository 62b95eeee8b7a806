#include "integration/tools/command/bench/choice/still_run.hpp"

#include "integration/tools/command/bench/merged_profiles.hpp"
#include "integration/tools/command/bench/still_error.hpp"
#include "integration/tools/command/interrupt.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

// The scenes are still, so few frames represent a long time, in which the choice measures errors
// and may switch.
constexpr float frame_seconds = 1.0f / 8;
constexpr uint32_t settling_frames = 30; // with a budget, before those of the result

demo::Result<> set_budget(TechniqueRun& run, const SceneRunRequest& request) {
  const dermis_source calibration =
      demo::source_of(request.calibration.name, request.calibration.text);
  dermis_budget budget = DERMIS_BUDGET_INIT;
  budget.milliseconds = static_cast<float>(request.budget_ms);
  budget.flags = DERMIS_BUDGET_DETERMINISTIC;
  budget.calibration = request.calibration.text.empty() ? nullptr : &calibration;
  return run.set_budget(budget);
}

RunFrame frame_of(TechniqueRun& run) {
  RunFrame out;
  const auto choice = run.choice();
  if (!choice) return out;
  out.choice.configuration = choice->configuration;
  out.choice.calibrated_ms = choice->calibrated_ms;
  out.choice.measured_ms = choice->measured_ms;
  out.choice.switches = choice->switches;
  return out;
}

} // namespace

std::vector<const FamilyScene*> find_family_scenes(const std::string& name) {
  std::vector<const FamilyScene*> found;
  for (const FamilyScene& scene : family_scenes())
    if (scene.name == name || scene.member.scene_class == name || scene.member.half == name)
      found.push_back(&scene);
  return found;
}

demo::Result<TechniqueRun*> StillRuns::graph_of(const SceneRunRequest& request, bool with_budget) {
  const auto make = [&] {
    TechniqueRequest technique;
    technique.graph = request.graph;
    technique.set = request.set;
    return TechniqueRun::create(host_, technique, profiles_, {});
  };
  if (with_budget) {
    if (with_budget_ == nullptr) {
      auto made = make();
      if (!made) return made.error();
      with_budget_ = made.take();
    }
    return with_budget_.get();
  }
  auto known = std::ranges::find(graphs_, request.set, &Graph::set);
  if (known == graphs_.end()) {
    auto made = make();
    if (!made) return made.error();
    graphs_.push_back({request.set, made.take()});
    known = graphs_.end() - 1;
  }
  return known->run.get();
}

void StillRuns::show(const SceneRunRequest& request, const FamilyScene& scene) {
  if (profiles_.empty()) // numbered once for all scenes, because graphs outlive a scene
    for (const FamilyScene& each : family_scenes()) {
      CapturedFrame small = generate_family_scene(each, 16, 16, skin_);
      merge_profiles(profiles_, small);
    }
  if (shown_ == &scene) return;
  frame_ = generate_family_scene(scene, request.size.width, request.size.height, skin_);
  merge_profiles(profiles_, frame_);
  shown_ = &scene;
}

demo::Result<SceneRun> StillRuns::run(const SceneRunRequest& request, const FamilyScene& scene,
                                      SharedScene& shared) {
  show(request, scene);
  const bool with_budget = request.budget_ms > 0;
  const auto graph = graph_of(request, with_budget);
  if (!graph) return graph.error();
  TechniqueRun& technique = **graph;
  auto reference = shared.references.find(0);
  if (reference == shared.references.end()) {
    auto made = make_reference(session_, frame_, scene.name, request.subset, request.cache);
    if (!made) return stopped();
    reference = shared.references.emplace(0, std::move(*made)).first;
  }
  SceneRun out;
  out.device = host_.properties.deviceName;
  technique.set_frame_seconds(frame_seconds);
  const uint32_t first = with_budget ? settling_frames : 0;
  for (uint32_t i = 0; i < first + request.frames; ++i) {
    if (interrupted()) return stopped();
    const auto light = technique.scatter(frame_, i > 0);
    if (!light) return light.error();
    if (i == 0)
      if (auto set = set_budget(technique, request); !set) return set.error();
    if (i < first) continue;
    RunFrame& frame = out.frames.emplace_back(frame_of(technique));
    if (request.error_every > 0 && (i - first) % request.error_every == request.error_every - 1)
      frame.rmse = still_error(*light, reference->second).figures.rmse;
  }
  return out;
}

} // namespace dermis::tools
