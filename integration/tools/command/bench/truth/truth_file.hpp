#pragma once
// Contents of tests/benchmark/truth.json: techniques under test and their tolerances.

#include "integration/tools/command/bench/truth/properties.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

using Tolerances = std::vector<std::pair<std::string, double>>; // property, absolute tolerance

struct PropertyTechnique : TechniqueRequest {
  Tolerances tolerances;
};

struct PropertyFile {
  Tolerances reference;
  std::vector<PropertyTechnique> techniques;
};

// Returns nullopt with located errors.
std::optional<PropertyFile> read_property_file(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
