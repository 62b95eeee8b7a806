#include "integration/tools/command/run/history_report.hpp"

#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

namespace dermis::tools {

std::string describe_histories(std::span<const demo::FrameHistory> histories) {
  if (histories.empty()) return "";
  Table table;
  table.columns = {{"history"}, {"holds"}, {"state"}};
  for (const demo::FrameHistory& one : histories)
    table.rows.push_back(
        {one.name, one.valid ? format_count(one.age, "frame") : std::string("nothing"), one.why});
  return format_table(table);
}

void write_histories(JsonWriter& writer, std::span<const demo::FrameHistory> histories) {
  writer.open_array();
  for (const demo::FrameHistory& one : histories)
    writer.open_object(true)
        .member("name", std::string_view(one.name))
        .member("valid", one.valid)
        .member("age", one.age)
        .member("why", std::string_view(one.why))
        .close();
  writer.close();
}

} // namespace dermis::tools
