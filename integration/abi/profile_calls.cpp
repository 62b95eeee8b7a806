// Replaces profiles of a graph while it runs.
#include "integration/abi/graph.hpp"
#include "integration/abi/graph_desc.hpp"
#include "integration/abi/report.hpp"
#include "integration/abi/settling.hpp"

#include <algorithm>

namespace dermis::abi {
namespace {

constexpr const char* function = "dermis_graph_set_profile";

// Reports how long the histories of the graph's own view show the replaced profile.
void add_settling(const PassTypeRegistry& pass_types, const CompiledGraph& compiled_graph,
                  uint32_t configuration, uint32_t id, Diagnostics& diagnostics) {
  std::vector<ResourceId> known;
  for (const RunnablePlan& runnable : compiled_graph.plans) {
    const Plan& plan = runnable.compiled->plan;
    for (uint32_t h = 0; h < plan.histories.size(); ++h) {
      const ResourceId declared = plan.resources[plan.histories[h].resource].declared;
      const uint32_t frames = settling_frames(
          pass_types, plan, h, compiled_graph.configurations[configuration].settings);
      if (frames <= 1 || std::find(known.begin(), known.end(), declared) != known.end()) continue;
      known.push_back(declared);
      const ResourceDeclaration& resource = compiled_graph.graph.resources[declared.value];
      diagnostics.add(
          DiagnosticId::profile_settles, resource.where,
          fmt::format("profile {}: after {} frames at most 1 % of history '{}' is from before the "
                      "change",
                      id, frames, resource.name));
    }
  }
}

// Writes the tables of `input` to device memory, and creates those of each view.
vulkan::Error make_all_tables(dermis_graph_t& graph, CompiledGraphInput& input,
                              std::vector<std::shared_ptr<vulkan::ViewTables>>& of_views) {
  if (vulkan::Error error = make_tables(*graph.context, graph.input.tables->use, input))
    return error;
  vulkan::Error error;
  for_each_view(graph, [&](const dermis_view_t&) {
    if (!error) error = vulkan::ViewTables::create(input.device_tables, of_views.emplace_back());
  });
  return error;
}

// Replaces the tables after `input.profiles` has changed. Passes and plans stay unchanged.
dermis_result replace_tables(dermis_graph_t& graph, CompiledGraphInput&& input, uint32_t id,
                             dermis_report* report) {
  dermis_context_t& context = *graph.context;
  Diagnostics diagnostics;
  std::vector<std::shared_ptr<vulkan::ViewTables>> of_views;
  if (const vulkan::Error error = make_all_tables(graph, input, of_views)) {
    const dermis_result result = rejected(context, error, diagnostics);
    return conclude(context.log, result, std::move(diagnostics), report);
  }
  {
    const std::shared_ptr<CompiledGraph> kept = keep_newest(graph.own);
    const std::lock_guard lock(graph.own.mutex); // recording chooses a configuration
    add_settling(context.pass_types, *kept, kept->configuration, id, diagnostics);
  }
  const dermis_result result = conclude(context.log, DERMIS_OK, std::move(diagnostics), report);
  if (result != DERMIS_OK) return result;
  size_t number = 0;
  for_each_view(graph, [&](dermis_view_t& view) { // nothing fails from here on
    const std::shared_ptr<vulkan::ViewTables>& tables = of_views[number++];
    const std::lock_guard lock(view.mutex);
    for (const std::shared_ptr<CompiledGraph>& compiled_graph :
         {std::cref(view.running), std::cref(view.next)})
      if (compiled_graph) {
        compiled_graph->tables = tables;
        for (const RunnablePlan& plan : compiled_graph->plans)
          plan.executor->set_tables(tables);
      }
  });
  graph.input = std::move(input);
  return result;
}

dermis_result set_profile(dermis_graph_t& graph, uint32_t id, const dermis_source* source,
                          dermis_report* report) {
  const Log& log = graph.context->log;
  if (id == 0 || id > largest_profile_id)
    return bad_argument(log, "{}: id is {}, expected 1..{}", function, id, largest_profile_id);
  subsurface::NumberedProfile profile{id, {}};
  Diagnostics diagnostics;
  if (source != nullptr)
    if (const dermis_result result = read_profile_source(log, "dermis_graph_set_profile: source",
                                                         *source, profile, diagnostics);
        result != DERMIS_OK)
      return result;
  if (diagnostics.has_errors())
    return conclude(log, DERMIS_ERROR_CONFIG, std::move(diagnostics), report);
  const std::lock_guard changing(graph.changing);
  CompiledGraphInput input = graph.input;
  const auto at =
      std::find_if(input.profiles.begin(), input.profiles.end(),
                   [&](const subsurface::NumberedProfile& one) { return one.id == id; });
  if (source == nullptr) {
    if (at == input.profiles.end())
      return bad_argument(
          log, "{}: source is NULL, which removes a profile, but the graph has no profile {}",
          function, id);
    input.profiles.erase(at);
  } else if (at == input.profiles.end()) {
    input.profiles.push_back(std::move(profile));
  } else {
    *at = std::move(profile);
  }
  if (input.profiles.empty() == graph.input.profiles.empty())
    return replace_tables(graph, std::move(input), id, report);
  input.tables.reset(); // the plan gains or loses passes that serve scattering
  return replace_compiled_graphs(graph, std::move(input), vulkan::HistoryReason::reloaded, report);
}

} // namespace
} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_set_profile(dermis_graph graph, uint32_t id,
                                                              const dermis_source* source,
                                                              dermis_report* report) {
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "{}: graph is NULL", function);
  return guarded(graph->context->log, function, [&] {
    if (const dermis_result alive = check_alive(*graph->context, function); alive != DERMIS_OK)
      return alive;
    return set_profile(*graph, id, source, report);
  });
}
