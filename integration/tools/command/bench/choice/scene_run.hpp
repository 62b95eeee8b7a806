#pragma once
// Renders frames of a scene with choices by budget and records choices, times and errors.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/session.hpp"
#include "integration/tools/command/verbs.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct SceneRunRequest {
  std::string scene, graph; // files
  demo::ModelOptions model; // for scenes with a model
  Size size;
  uint32_t frames = 0;
  double frames_per_second = 0; // 0: the scene's rate
  uint32_t error_every = 0;     // interval in frames; 0: errors are not measured
  uint32_t subset = 1024;       // pixels per frame compared with the reference
  double budget_ms = 0;         // 0: no budget; default choices with `set` applied
  bool deterministic = false;
  std::vector<NamedValue> set; // values as JSON
  demo::NamedText calibration; // "": the library's calibration
  std::string cache;           // folder for references
  demo::ContextHooks hooks;
};

// State shared by runs of one scene, size and rate.
struct SharedScene {
  demo::RenderCacheHandle cache = demo::make_render_cache();
  std::map<uint32_t, Reference> references; // by frame number
};

struct RunFrame {
  demo::FrameChoice choice;
  std::optional<double> rmse;
};

struct SceneRun {
  std::string device;
  std::vector<RunFrame> frames;
};

// Errors: those of demo::render; environment "stopped" if interrupted.
demo::Result<SceneRun> run_scene(const Session& session, const SceneRunRequest& request,
                                 SharedScene& shared);

} // namespace dermis::tools
