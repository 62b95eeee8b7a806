#pragma once
// Contents of tests/benchmark/error_time.json, which describes `dermis bench error-time`. A
// technique, setting or framing is one entry.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/bench/suite/bench_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct ErrorTimeFile {
  // per technique and scene; 0 repetitions: times are not measured
  uint32_t repetitions = 15, warm_up = 2;
  // Timed runs of a technique on a scene end early after this duration, but not before
  // min_repetitions.
  uint32_t row_milliseconds = 0; // 0: no limit
  uint32_t min_repetitions = 3;
  uint32_t subset = 4096; // pixels per scene with a reference, if it is not computed everywhere
  std::string skin;       // profile of the generated scenes
  bool family = false;    // also measure the generated scenes of the family (family/family.hpp)
  std::string baseline_technique, baseline_setting; // denominator of ratios
  std::vector<SceneRequest> scenes;
  std::vector<TechniqueRequest> techniques;
  std::string self_setting;     // setting of the number of samples, in graphs that declare it
  uint32_t self_samples = 4096; // samples of the reference of psnr_db_self
  // "scene/framing" for which psnr_db_self is measured, which takes long
  std::vector<std::string> self_scenes;
  // side of the square in the image's middle used for psnr_db_self; 0: whole image
  uint32_t self_window = 0;
};

// Reads a scene of a bench file.
SceneRequest read_scene(BenchObject& entry);

// Returns nullopt with located errors.
std::optional<ErrorTimeFile> read_error_time(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
