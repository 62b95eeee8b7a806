#include "integration/tools/command/run/pass_times.hpp"

#include "integration/tools/command/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
void PassTimes::add(std::string_view pass, double milliseconds) {
  auto found = std::find_if(samples_.begin(), samples_.end(),
                            [&](const Samples& one) { return one.pass == pass; });
  if (found == samples_.end()) found = samples_.insert(found, {std::string(pass), {}});
  found->milliseconds.push_back(milliseconds);
  frames_.back() += milliseconds;
}

std::vector<PassTimes::Row> PassTimes::rows() const {
  std::vector<Row> rows;
  for (const Samples& one : samples_)
    rows.push_back({one.pass, median(one.milliseconds), one.milliseconds.size()});
  return rows;
}

double PassTimes::total() const {
  return frames_.empty() ? 0 : median(frames_);
}

std::string format_times(const PassTimes& times, const std::string& title) {
  const double total = times.total();
  const auto fraction = [&](double part) {
    return fmt::format("{:.1f} %", total > 0.0 ? 100.0 * part / total : 0.0);
  };
  Table table;
  const std::vector<PassTimes::Row> rows = times.rows();
  table.columns = {{fmt::format("{}, median of {}", title, times.frames())},
                   {"device time", true},
                   {"fraction", true}};
  for (const PassTimes::Row& row : rows)
    table.rows.push_back({row.pass, format_milliseconds(row.median), fraction(row.median)});
  table.rows.push_back({});
  table.rows.push_back({"all", format_milliseconds(total), fraction(total)});
  return format_table(table);
}

void write_times(JsonWriter& writer, const PassTimes& times) {
  writer.open_array();
  for (const PassTimes::Row& row : times.rows()) {
    writer.open_object(true).member("pass", row.pass).member("milliseconds", row.median);
    writer.member("frames", static_cast<uint64_t>(row.frames)).close();
  }
  writer.close();
}

} // namespace dermis::tools
