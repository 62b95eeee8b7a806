#pragma once
// Runs a graph with choices by budget on still scenes of the generated family.

#include "integration/tools/command/bench/choice/scene_run.hpp"
#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/technique.hpp"

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

// Returns the scenes of the family with this name, of this class or of this half.
std::vector<const FamilyScene*> find_family_scenes(const std::string& name);

// Keeps one graph per set of settings on the device; each scene starts with a cut. One thread.
// Destroy before the host.
class StillRuns {
public:
  // `skin`: profile of scenes with three different d.
  StillRuns(const Session& session, demo::VulkanHost& host, subsurface::Profile skin)
      : session_(session), host_(host), skin_(std::move(skin)) {}

  // Runs frames at 8 per second; with a budget, 30 more before those of the result. Uses graph, set,
  // size, frames, error_every, subset, budget_ms, calibration and cache of `request`; runs are
  // deterministic. Errors: those of TechniqueRun; environment "stopped".
  demo::Result<SceneRun> run(const SceneRunRequest& request, const FamilyScene& scene,
                             SharedScene& shared);

private:
  struct Graph {
    std::vector<NamedValue> set;
    std::unique_ptr<TechniqueRun> run;
  };
  demo::Result<TechniqueRun*> graph_of(const SceneRunRequest& request, bool with_budget);
  void show(const SceneRunRequest& request, const FamilyScene& scene);

  const Session& session_;
  demo::VulkanHost& host_;
  subsurface::Profile skin_;
  const FamilyScene* shown_ = nullptr; // scene of frame_
  CapturedFrame frame_;
  std::vector<CaptureProfile> profiles_; // of all scenes of the family
  std::vector<Graph> graphs_;            // one per set without a budget
  std::unique_ptr<TechniqueRun> with_budget_;
};

} // namespace dermis::tools
