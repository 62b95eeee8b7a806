#pragma once
// Contents of tests/benchmark/error_table.json, which describes `dermis bench error-table`.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/bench/suite/bench_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

// A technique at one setting. The rows of the error table that have its name, "sap smooth", get its
// errors. The technique "off" measures unscattered light.
struct TabledTechnique : TechniqueRequest {
  uint32_t frames = 1; // the error is that of the last of so many frames at rest
};

struct ErrorTableFile {
  uint32_t subset = 1024;           // pixels per scene with a reference, except planes
  std::string skin;                 // profile of the generated scenes
  std::vector<double> d_px;         // of the table, ascending
  std::vector<SceneRequest> scenes; // rendered scenes in addition to the family
  std::vector<TabledTechnique> techniques;
  std::vector<std::string> choice; // names of rows among which a budget without limit would choose
};

// Returns nullopt with located errors.
std::optional<ErrorTableFile> read_error_table(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
