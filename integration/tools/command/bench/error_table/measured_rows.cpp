#include "integration/tools/command/bench/error_table/measured_rows.hpp"

#include "framegraph/text/reader.hpp"
#include "integration/tools/command/bench/suite/bench_file.hpp"

namespace dermis::tools {
namespace {

constexpr size_t max_rows = 1 << 20;
constexpr double largest_rmse = 1e6;

ErrorTableRow read_row(const Document& document, NodeId node, Diagnostics& diagnostics) {
  ErrorTableRow row;
  ObjectReader object(document, node, "row", diagnostics);
  MeasuredError& error = row.error;
  error.scene = object.string("scene").value_or("");
  error.scene_class = object.string("class").value_or("");
  error.half = object.string("half").value_or("");
  error.technique = object.string("technique").value_or("");
  error.d_px = object.number("d_px", min_d_px, max_d_px).value_or(1);
  error.rmse = object.number("rmse", 0, largest_rmse).value_or(0);
  error.relief = object.number("relief", -1, 1).value_or(-1);
  row.frames = static_cast<uint32_t>(object.integer("frames", 1, 4096).value_or(1));
  object.finish();
  return row;
}

} // namespace

std::optional<MeasuredRows> read_measured_rows(const std::string& path, Diagnostics& diagnostics) {
  const auto document = read_document(path, diagnostics);
  if (!document) return std::nullopt;
  MeasuredRows out;
  ObjectReader root(*document, document->root(), "report", diagnostics);
  constexpr std::string_view kinds[] = {"error-table"};
  root.word("dermis_bench", kinds);
  root.any("notes");
  const NodeId facts = root.object("facts"), rows = root.array("rows", 1, max_rows);
  if (!root.ok()) return std::nullopt;
  root.finish();
  for (const NodeId fact : children(*document, facts))
    if (document->key(fact) == "device" && (*document)[fact].kind == NodeKind::string)
      out.device = document->text(fact);
  for (const NodeId row : children(*document, rows))
    out.rows.push_back(read_row(*document, row, diagnostics));
  if (diagnostics.errors() > 0) return std::nullopt;
  return out;
}

} // namespace dermis::tools
