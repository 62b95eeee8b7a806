#pragma once
// Which techniques the laws are asked of, and how far each may miss: tests/benchmark/truth.json.

#include "integration/tools/command/bench/laws/laws.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

using Tolerances = std::vector<std::pair<std::string, double>>; // law, absolute

struct LawTechnique {
  TechniqueRequest request;
  Tolerances tolerances;
};

struct LawFile {
  Tolerances truth;
  std::vector<LawTechnique> techniques;
};

// nullopt with located errors.
std::optional<LawFile> read_law_file(const std::string& path, Diagnostics& diagnostics);

} // namespace dermis::tools
