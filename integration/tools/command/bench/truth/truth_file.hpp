#pragma once
// Which techniques the laws are asked of, and how far each may miss: tests/benchmark/truth.json.

#include "integration/tools/command/bench/truth/properties.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

using Tolerances = std::vector<std::pair<std::string, double>>; // law, absolute

struct PropertyTechnique {
  TechniqueRequest request;
  Tolerances tolerances;
};

struct PropertyFile {
  Tolerances reference;
  std::vector<PropertyTechnique> techniques;
};

// nullopt with located errors.
std::optional<PropertyFile> read_property_file(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
