#include "integration/tools/command/bench/suite/techniques.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace dermis::tools {

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

demo::Error none_selected(std::string_view kind, std::vector<std::string> known) {
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  return {demo::ErrorKind::usage,
          fmt::format("no {} is selected; available: {}", kind, format_list(known))};
}

demo::Result<> check_names(const SuiteRun& run, const std::string& option,
                           std::vector<std::string> known, std::vector<std::string> listed) {
  std::vector<std::string> unknown;
  for (const std::string& name : run.list(option))
    if (std::ranges::find(known, name) == known.end()) unknown.push_back("'" + name + "'");
  if (unknown.empty()) return demo::success();
  if (listed.empty()) listed = std::move(known);
  std::sort(listed.begin(), listed.end());
  listed.erase(std::unique(listed.begin(), listed.end()), listed.end());
  return demo::Error{demo::ErrorKind::usage,
                     fmt::format("--{}: unknown {}; available: {}", option, format_list(unknown),
                                 format_list(listed))};
}

} // namespace dermis::tools
