// Reads any bytes as a graph file. The result is diagnostics or a graph; a graph that compiles
// passes the verifier and can be written.

#include "framegraph/compile/compile.hpp"
#include "framegraph/explain/plan_dot.hpp"
#include "framegraph/explain/plan_json.hpp"
#include "framegraph/model/read_graph.hpp"
#include "framegraph/verify/verify.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace dermis;
  static const PassTypeRegistry pass_types = subsurface::make_pass_types();
  static const DeviceProfile device = generic_profile();
  Diagnostics diagnostics;
  const auto document = parse_document("input.json", fuzz::text_of(data, size), diagnostics);
  if (!document) return fuzz::demand_error(diagnostics);
  const auto graph = read_graph(*document, pass_types, diagnostics);
  if (!graph) return fuzz::demand_error(diagnostics);
  CompileInput input;
  input.graph = &*graph;
  input.pass_types = &pass_types;
  input.device = &device;
  input.view_width = 64;
  input.view_height = 48;
  const auto plan = compile(input, diagnostics);
  if (!plan) return fuzz::demand_error(diagnostics);
  fuzz::demand(verify(plan->plan).violations.empty(),
               "the verifier rejects a plan of the compiler");
  fuzz::demand(!plan_json(*graph, pass_types, *plan).empty() &&
                   !plan_dot(*graph, pass_types, *plan).empty(),
               "a plan cannot be written");
  return 0;
}
