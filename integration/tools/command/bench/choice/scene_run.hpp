#pragma once
// A scene rendered over some frames with choices by budget: what was chosen, what it took and how far it was
// off.

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
  demo::ModelOptions model; // of scenes that show one
  Size size;
  uint32_t frames = 0;
  double frames_per_second = 0; // 0: the scene's
  uint32_t error_every = 0;     // frames; 0: errors are not measured
  uint32_t subset = 1024;       // pixels of a frame that are compared with the truth
  double budget_ms = 0;         // 0: the defaults, with `set`
  bool deterministic = false;
  std::vector<NamedValue> set; // JSON texts
  demo::NamedText calibration; // "": the library's own
  std::string cache;           // folder for references
  demo::ContextHooks hooks;
};

// What runs of one scene, size and rate share.
struct SharedScene {
  demo::StageHandle stage = demo::make_stage();
  std::map<uint32_t, Reference> references; // by number of frame
};

struct RunFrame {
  demo::FrameChoice choice;
  std::optional<double> rmse;
};

struct SceneRun {
  std::string device;
  std::vector<RunFrame> frames;
};

// Errors: those of demo::render; environment "stopped" when interrupted.
demo::Result<SceneRun> run_scene(const Session& session, const SceneRunRequest& request, SharedScene& shared);

} // namespace dermis::tools
