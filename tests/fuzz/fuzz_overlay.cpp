// Reads any bytes as an overlay on a small graph. The result is diagnostics, or a graph in which
// every change has a place.

#include "framegraph/compose/compose.hpp"
#include "framegraph/model/read_graph.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace {

constexpr const char* base = R"({ "dermis": 2, "name": "base",
  "settings": { "samples": { "int": 16, "min": 4, "max": 64 } },
  "imports": { "material": { "format": "r8_uint", "size": "view" }, "depth": { "format": "depth", "size": "view" } },
  "resources": { "classes": { "buffer": { "stride": 4, "count": "view/8" } } },
  "passes": [ { "pass": "classify", "type": "subsurface.classify",
    "read": { "material": "material", "depth": "depth" }, "write": { "classes": "classes" } } ] })";

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace dermis;
  static const PassTypeRegistry pass_types = subsurface::make_pass_types();
  Diagnostics diagnostics;
  auto graph = parse_document("base.json", base, diagnostics);
  auto overlay = parse_document("input.json", fuzz::text_of(data, size), diagnostics);
  if (!overlay) return fuzz::demand_error(diagnostics);
  std::vector<Document> overlays;
  overlays.push_back(std::move(*overlay));
  const auto composition = compose(
      std::move(*graph), std::move(overlays),
      [](std::string_view name) {
        return FileText{std::string(name), R"({ "dermis_fragment": 2 })", ""};
      },
      diagnostics);
  if (!composition) return fuzz::demand_error(diagnostics);
  for (const Change& change : composition->changes)
    fuzz::demand(change.where.file.value < diagnostics.files.size(), "a change comes from no file");
  if (!read_graph(composition->document, pass_types, diagnostics))
    return fuzz::demand_error(diagnostics);
  return 0;
}
