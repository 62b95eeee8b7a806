#include "integration/abi/graph.hpp"
#include "integration/abi/report.hpp"
#include "integration/abi/shaders/compiler.hpp"

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_reload_shaders(dermis_graph graph,
                                                                 dermis_include_fn open, void* user,
                                                                 dermis_report* report) {
  constexpr const char* function = "dermis_graph_reload_shaders";
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "{}: graph is NULL", function);
  const Log& log = graph->context->log;
  return guarded(log, function, [&] {
    if (const dermis_result alive = check_alive(*graph->context, function); alive != DERMIS_OK)
      return alive;
    if (open != nullptr && shader_compiler().empty()) {
      dermis::Diagnostics diagnostics;
      std::vector<std::vector<uint32_t>> none;
      compile_shaders({}, {}, none, diagnostics); // adds the error
      return conclude(log, DERMIS_ERROR_UNSUPPORTED, std::move(diagnostics), report);
    }
    const std::lock_guard changing(graph->changing);
    CompiledGraphInput input = graph->input;
    use_shaders(input.shaders, open, user);
    return replace_compiled_graphs(*graph, std::move(input),
                                   dermis::vulkan::HistoryReason::reloaded, report);
  });
}
