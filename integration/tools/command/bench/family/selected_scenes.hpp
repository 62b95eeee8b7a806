#pragma once
// Selects scenes by --scenes: names, and for the family also classes and halves.

#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/bench/suite/suite.hpp"

#include <span>
#include <string>

namespace dermis::tools {

// Returns whether --scenes requests a scene by its name, class or half.
bool is_selected(const SuiteRun& run, const std::string& scene, const FamilyMember& member);

// Returns the usage error if --scenes has a name that is neither one of `scenes` nor, with
// `family`, of the generated family.
demo::Result<> check_scenes(const SuiteRun& run, std::span<const SceneRequest> scenes, bool family);

} // namespace dermis::tools
