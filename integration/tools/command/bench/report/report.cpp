#include "integration/tools/command/bench/report/report.hpp"

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/output.hpp"
#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>

namespace dermis::tools {
namespace {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) {
      const size_t colon = line.find(": ");
      if (colon != std::string::npos) return line.substr(colon + 2);
    }
  return "unknown";
}

void write_value(JsonWriter& out, const ReportValue& value) {
  std::visit(
      [&](const auto& held) {
        if constexpr (std::is_same_v<std::decay_t<decltype(held)>, std::monostate>)
          out.null();
        else
          out.value(held);
      },
      static_cast<const ReportVariant&>(value));
}

// Returns the object of a key "object.member", or "".
std::string_view object_of(const ReportColumn& column) {
  const size_t dot = column.key.find('.');
  return dot == std::string::npos ? "" : std::string_view(column.key).substr(0, dot);
}

// Columns of one object are neighbours. The object is omitted if its first member was not measured.
void write_row(JsonWriter& out, const ReportTable& table, const std::vector<ReportValue>& row) {
  out.open_object(true);
  for (size_t i = 0; i < row.size();) {
    const std::string_view object = object_of(table.columns[i]);
    if (object.empty()) {
      write_value(out.key(table.columns[i].key), row[i]);
      ++i;
      continue;
    }
    const bool measured = !std::holds_alternative<std::monostate>(row[i]);
    if (measured) out.key(object).open_object(true);
    for (; i < row.size() && object_of(table.columns[i]) == object; ++i)
      if (measured) write_value(out.key(table.columns[i].key.substr(object.size() + 1)), row[i]);
    if (measured) out.close();
  }
  out.close();
}

// Large numbers are whole numbers instead of powers of ten.
std::string number_text(double value, int digits) {
  constexpr double huge = 1e12;
  const double size = std::abs(value);
  return size >= std::pow(10.0, digits) && size < huge ? fmt::format("{:.0f}", value)
                                                       : fmt::format("{:.{}g}", value, digits);
}

// Quotes text for CSV (RFC 4180).
std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted(1, '"');
  for (const char c : text)
    quoted.append(c == '"' ? 2 : 1, c);
  quoted.push_back('"');
  return quoted;
}

std::string csv_value(const ReportValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* whole = std::get_if<int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&value))
    return std::isfinite(*number) ? fmt::format("{}", *number) : "";
  if (const auto* text = std::get_if<std::string>(&value)) return csv_field(*text);
  return "";
}

} // namespace

bool is_baseline(std::string_view technique) {
  // prefixes, for example of sap_residual
  constexpr std::string_view own[] = {"sap", "hybrid", "restir"};
  return std::none_of(std::begin(own), std::end(own),
                      [&](std::string_view name) { return technique.starts_with(name); });
}

std::string cell_text(const ReportValue& value, const ReportColumn& column) {
  if (const auto* flag = std::get_if<bool>(&value))
    return *flag ? "yes" : column.style.goal == Goal::best ? "" : "no";
  if (const auto* whole = std::get_if<int64_t>(&value)) return fmt::format("{}", *whole);
  if (const auto* number = std::get_if<double>(&value); number != nullptr && std::isfinite(*number))
    return number_text(*number, column.style.digits);
  const auto* text = std::get_if<std::string>(&value);
  return text != nullptr ? *text : "-";
}

bool is_text(const ReportTable& table, size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(), [&](const auto& row) {
    return std::holds_alternative<std::string>(row[column]);
  });
}

GoalCount count_goals(const ReportTable& table, Goal goal) {
  GoalCount count;
  for (const auto& row : table.rows)
    for (size_t i = 0; i < row.size(); ++i)
      if (const auto* flag = std::get_if<bool>(&row[i]);
          flag != nullptr && table.columns[i].style.goal == goal) {
        ++count.rows;
        count.missed += *flag ? 0 : 1;
      }
  return count;
}

std::string verdict_of(const ReportTable& table) {
  const GoalCount required = count_goals(table, Goal::required),
                  advisory = count_goals(table, Goal::advisory);
  const size_t rows = table.rows.size();
  if (required.missed > 0) return fmt::format("{} of {} rows miss a goal", required.missed, rows);
  if (advisory.missed > 0)
    return fmt::format("{} of {} rows miss a goal that is not required", advisory.missed, rows);
  if (required.rows + advisory.rows == 0) return "";
  return fmt::format("all goals of {} rows are met", rows);
}

std::vector<std::pair<std::string, std::string>> machine_info(const std::string& command,
                                                              const std::string& device) {
  std::vector<std::pair<std::string, std::string>> info = {{"command", command}};
  if (!device.empty()) info.emplace_back("device", device);
  info.emplace_back("processor", processor_name());
  info.emplace_back("hardware threads", fmt::format("{}", std::thread::hardware_concurrency()));
  return info;
}

std::string report_as_text(const Report& report) {
  const ReportTable& all = report.table;
  Table table;
  std::vector<size_t> shown;
  for (size_t i = 0; i < all.columns.size(); ++i)
    if (all.columns[i].style.in_text && !all.columns[i].title.empty()) {
      shown.push_back(i);
      table.columns.push_back({all.columns[i].title, !is_text(all, i)});
    }
  std::string group;
  for (const auto& row : all.rows) {
    std::string own;
    for (size_t i = 0; i < row.size(); ++i)
      if (all.columns[i].style.groups) own += cell_text(row[i], all.columns[i]) + '\n';
    if (!table.rows.empty() && own != group) table.rows.emplace_back();
    group = own;
    auto& cells = table.rows.emplace_back();
    for (const size_t i : shown)
      cells.push_back(cell_text(row[i], all.columns[i]));
  }
  std::string text = report.text.empty() ? format_table(table) : report.text;
  for (const std::string& note : report.notes)
    text += fmt::format("left out: {}\n", note);
  for (const auto& [name, fact] : report.info)
    text += fmt::format("{}: {}\n", name, fact);
  return text;
}

std::string report_as_json(const Report& report) {
  JsonWriter out;
  out.open_object().member("dermis_bench", report.bench);
  for (const auto& [name, value] : report.constants)
    write_value(out.key(name), value);
  out.key("facts").open_object();
  for (const auto& [name, text] : report.info)
    out.member(name, text);
  out.close().key("notes").open_array();
  for (const std::string& note : report.notes)
    out.value(note);
  out.close().key("rows").open_array();
  for (const auto& row : report.table.rows)
    write_row(out, report.table, row);
  out.close().close();
  return std::move(out).finish();
}

std::string report_as_csv(const Report& report) {
  std::string text;
  const auto line = [&](auto&& cell) {
    for (size_t i = 0; i < report.table.columns.size(); ++i)
      text.append(i == 0 ? "" : ",").append(cell(i));
    text += "\r\n";
  };
  line([&](size_t i) { return csv_field(report.table.columns[i].key); });
  for (const auto& row : report.table.rows)
    line([&](size_t i) { return csv_value(row[i]); });
  return text;
}

std::string deliver_report(const Report& report, const std::string& json, const std::string& csv,
                           const std::string& html) {
  const std::string problems[] = {
      json.empty() ? "" : deliver_text(json, report_as_json(report)),
      csv.empty() ? "" : deliver_text(csv, report_as_csv(report)),
      html.empty() ? "" : deliver_page(html, report_as_html(report)),
  };
  for (const std::string& problem : problems)
    if (!problem.empty()) return problem;
  return "";
}

} // namespace dermis::tools
