#include "integration/tools/command/bench/family/selected_scenes.hpp"

#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"

namespace dermis::tools {

bool is_selected(const SuiteRun& run, const std::string& scene, const FamilyMember& member) {
  return run.is_requested("scenes", scene) || run.is_requested("scenes", member.scene_class) ||
         run.is_requested("scenes", member.half);
}

demo::Result<> check_scenes(const SuiteRun& run, std::span<const SceneRequest> scenes,
                            bool family) {
  std::vector<std::string> listed; // without the names of the family, which are more than 100
  const auto add = [&](const FamilyMember& member) {
    for (const std::string& word : {member.scene_class, member.half})
      if (!word.empty()) listed.push_back(word);
  };
  for (const SceneRequest& scene : scenes) {
    listed.push_back(scene.scene);
    add(scene.member);
  }
  if (!family) return check_names(run, "scenes", listed);
  std::vector<std::string> known;
  for (const FamilyScene& scene : family_scenes()) {
    known.push_back(scene.name);
    add(scene.member);
  }
  known.insert(known.end(), listed.begin(), listed.end());
  return check_names(run, "scenes", std::move(known), std::move(listed));
}

} // namespace dermis::tools
