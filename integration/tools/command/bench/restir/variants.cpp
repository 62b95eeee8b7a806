#include "integration/tools/command/bench/restir/variants.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

const std::vector<std::string>& options_of(const Graph& graph, std::string_view setting) {
  static const std::vector<std::string> none;
  const auto found =
      std::find_if(graph.settings.begin(), graph.settings.end(),
                   [&](const SettingDeclaration& one) { return one.name == setting; });
  return found == graph.settings.end() ? none : found->options;
}

} // namespace

std::vector<RestirVariant> variants_of(const Graph& graph) {
  std::vector<RestirVariant> variants(1);
  for (const std::string& reuse : options_of(graph, "reuse"))
    for (const std::string& shift : options_of(graph, "shift"))
      if (reuse != variants.front().reuse) variants.push_back({reuse, shift});
  return variants;
}

double ratio_at_equal_time(double mse, double ms, double mse_of_none, double ms_of_none) {
  return mse * ms / (mse_of_none * ms_of_none);
}

} // namespace dermis::tools
