#include "framegraph/compile/compile.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/model/read_graph.hpp"
#include "framegraph/text/document.hpp"
#include "integration/abi/graph_desc.hpp"
#include "integration/abi/report.hpp"
#include "passes/common/pass_types.hpp"

namespace dermis::abi {
namespace {

// Any view size reveals cycles, missing producers and formats; creation checks sizes again.
constexpr uint32_t validation_width = 1920, validation_height = 1080;

dermis_result validate(const dermis_source* given, dermis_report* report) {
  dermis_source source = DERMIS_SOURCE_INIT;
  if (const SizedRead read = read_sized(given, source); read != SizedRead::ok)
    return rejected_size({}, read, "dermis_validate: source", stated_size(given),
                         sizeof(dermis_source));
  std::string name, text;
  if (const dermis_result result = read_source({}, "dermis_validate: source", source, name, text);
      result != DERMIS_OK)
    return result;
  Diagnostics diagnostics;
  const PassTypeRegistry pass_types = subsurface::make_pass_types();
  const DeviceProfile device = generic_profile();
  bool valid = false;
  auto document = parse_document(std::move(name), std::move(text), diagnostics);
  const auto composition =
      document ? compose(std::move(*document), {}, {}, diagnostics) : std::optional<Composition>();
  if (composition)
    if (const auto graph = read_graph(composition->document, pass_types, diagnostics)) {
      CompileInput input;
      input.graph = &*graph;
      input.pass_types = &pass_types;
      input.device = &device;
      input.view_width = validation_width;
      input.view_height = validation_height;
      valid = compile(input, diagnostics).has_value();
    }
  return conclude({}, valid && !diagnostics.has_errors() ? DERMIS_OK : DERMIS_ERROR_CONFIG,
                  std::move(diagnostics), report);
}

} // namespace
} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_validate(const dermis_source* source,
                                                     dermis_report* report) {
  if (report != nullptr) *report = nullptr;
  return guarded({}, "dermis_validate", [&] {
    if (source == nullptr) return bad_argument({}, "dermis_validate: source is NULL");
    return validate(source, report);
  });
}
