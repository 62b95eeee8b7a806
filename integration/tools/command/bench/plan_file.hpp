#pragma once
// What `dermis bench error-time` measures, as data: tests/benchmark/error_time.json. Adding a technique, a
// setting or a framing is a line there.

#include "framegraph/text/reader.hpp"
#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/verbs.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct TechniqueRequest {
  std::string technique, setting;         // names in the report
  std::string graph;                      // file
  std::vector<NamedValue> set;            // of the graph's settings
  bool heat_map = false;                  // show where it errs
  std::vector<std::string> overlays = {}; // files, in order
};

struct ErrorTimeFile {
  uint32_t repetitions = 15, warm_up = 2; // of each technique at each scene
  // Timed runs of a technique at a scene end early once they took so long, but not before the least number.
  uint32_t row_milliseconds = 0; // 0: never
  uint32_t min_repetitions = 3;
  uint32_t subset = 4096; // pixels of a scene that have a truth, where it is not known everywhere
  std::string skin;       // profile of the generated scenes
  std::string baseline_technique, baseline_setting; // what ratios are to
  std::vector<SceneRequest> scenes;
  std::vector<TechniqueRequest> techniques;
  std::string self_setting;             // that sets the number of samples, where a graph has it
  uint32_t self_samples = 4096;         // of the reference of psnr_db_self
  std::vector<std::string> self_scenes; // "scene/framing" where that is measured; it takes long
  uint32_t self_window = 0; // side of the square in the picture's middle that it is measured on; 0: all
};

// The keys technique, setting, graph, overlays, set and heat_map of an entry; whoever calls finishes the
// object.
TechniqueRequest read_technique(const Document& document, ObjectReader& object, Diagnostics& diagnostics);

// The optional key camera of an entry.
std::optional<demo::CameraPlace> read_camera(const Document& document, ObjectReader& object,
                                             Diagnostics& diagnostics);

// nullopt with located errors.
std::optional<ErrorTimeFile> read_error_time(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
