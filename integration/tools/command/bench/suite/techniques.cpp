#include "integration/tools/command/bench/suite/techniques.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace dermis::tools {
namespace {

// Without duplicates.
std::string sorted_list(std::vector<std::string> words) {
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return format_list(words);
}

} // namespace

std::string name_of(const TechniqueRequest& technique) {
  return fmt::format("{} {}", technique.technique, technique.setting);
}

bool is_usable(SuiteRun& run, const TechniqueRequest& technique) {
  if (run.options.contains("techniques") && !run.is_requested("techniques", technique.technique))
    return false;
  if (std::filesystem::exists(technique.graph)) return true;
  run.add_note(
      fmt::format("technique {}: graph '{}' does not exist", name_of(technique), technique.graph));
  return false;
}

bool is_one_of_few(std::string_view technique) {
  constexpr std::string_view few[] = {"sap", "sap_residual", "burley", "afis_guided", "separable"};
  return std::find(std::begin(few), std::end(few), technique) != std::end(few);
}

demo::Error no_scene_selected(std::vector<std::string> known) {
  return {demo::ErrorKind::usage,
          fmt::format("no scene is selected; available: {}", sorted_list(std::move(known)))};
}

demo::Error no_graph_exists(std::vector<std::string> graphs) {
  return {demo::ErrorKind::input, fmt::format("the graphs of the techniques do not exist: {}",
                                              sorted_list(std::move(graphs)))};
}

demo::Result<> check_names(const SuiteRun& run, const std::string& option,
                           std::vector<std::string> known, std::vector<std::string> listed) {
  std::vector<std::string> unknown;
  for (const std::string& name : run.list(option))
    if (std::ranges::find(known, name) == known.end()) unknown.push_back("'" + name + "'");
  if (unknown.empty()) return demo::success();
  if (listed.empty()) listed = std::move(known);
  return demo::Error{demo::ErrorKind::usage,
                     fmt::format("--{}: unknown {}; available: {}", option, format_list(unknown),
                                 sorted_list(std::move(listed)))};
}

} // namespace dermis::tools
