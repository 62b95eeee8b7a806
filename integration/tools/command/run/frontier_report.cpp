#include "integration/tools/command/run/frontier_report.hpp"

#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

namespace dermis::tools {

std::string describe_frontier(std::span<const demo::FrameOutcome> outcomes) {
  if (outcomes.size() < 2) return "";
  Table table;
  table.columns = {{"configuration"}, {"expected", true}, {"at percentile", true},
                   {"RMSE", true},    {"memory", true},   {""}};
  for (const demo::FrameOutcome& one : outcomes)
    table.rows.push_back({one.configuration, format_milliseconds(one.expected_ms),
                          format_milliseconds(one.percentile_ms),
                          fmt::format("{:.1e}", one.expected_rmse),
                          format_bytes(one.transient_bytes + one.history_bytes),
                          !one.fits       ? "over the budget"
                          : one.dominated ? "dominated"
                                          : ""});
  return format_table(table);
}

void write_frontier(JsonWriter& writer, std::span<const demo::FrameOutcome> outcomes) {
  writer.open_array();
  for (const demo::FrameOutcome& one : outcomes)
    writer.open_object(true)
        .member("configuration", std::string_view(one.configuration))
        .member("expected_ms", one.expected_ms)
        .member("percentile_ms", one.percentile_ms)
        .member("expected_rmse", one.expected_rmse)
        .member("fits", one.fits)
        .member("dominated", one.dominated)
        .member("transient_bytes", one.transient_bytes)
        .member("history_bytes", one.history_bytes)
        .close();
  writer.close();
}

} // namespace dermis::tools
