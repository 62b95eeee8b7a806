#include "integration/tools/command/bench/report/report.hpp"

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/output.hpp"

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
        using Held = std::decay_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, std::monostate>)
          out.null();
        else
          out.value(held);
      },
      value);
}

// Quotes text for CSV (RFC 4180).
std::string csv_text(const std::string& text) {
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
  if (const auto* text = std::get_if<std::string>(&value)) return csv_text(*text);
  return "";
}

} // namespace

bool is_baseline(std::string_view technique) {
  // prefixes, for example of sap_residual
  constexpr std::string_view own[] = {"sap", "hybrid", "restir"};
  return std::none_of(std::begin(own), std::end(own),
                      [&](std::string_view name) { return technique.starts_with(name); });
}

const ReportValue& ReportTable::at(size_t row, std::string_view key) const {
  const auto column =
      std::find_if(columns.begin(), columns.end(), [&](const ReportColumn& one) { return one.key == key; });
  return rows[row][static_cast<size_t>(column - columns.begin())];
}
ReportValue& ReportTable::at(size_t row, std::string_view key) {
  return const_cast<ReportValue&>(std::as_const(*this).at(row, key));
}

std::string ReportTable::text_at(size_t row, std::string_view key, int digits) const {
  const ReportValue& value = at(row, key);
  if (const auto* words = std::get_if<std::string>(&value)) return *words;
  if (const auto* reference = std::get_if<bool>(&value)) return *reference ? "yes" : "no";
  const auto* number = std::get_if<double>(&value);
  return number != nullptr ? fmt::format("{:.{}f}", *number, digits) : "-";
}

std::vector<std::pair<std::string, std::string>> machine_info(const std::string& command,
                                                              const std::string& device) {
  std::vector<std::pair<std::string, std::string>> info = {{"command", command}};
  if (!device.empty()) info.emplace_back("device", device);
  info.emplace_back("processor", processor_name());
  info.emplace_back("hardware threads", fmt::format("{}", std::thread::hardware_concurrency()));
  return info;
}

std::string report_as_json(const Report& report) {
  JsonWriter out;
  out.open_object().member("dermis_bench", report.bench);
  out.key("facts").open_object();
  for (const auto& [name, text] : report.info)
    out.member(name, text);
  out.close().key("notes").open_array();
  for (const std::string& note : report.notes)
    out.value(note);
  out.close().key("rows").open_array();
  for (const auto& row : report.table.rows) {
    out.open_object(true);
    for (size_t i = 0; i < row.size(); ++i)
      write_value(out.key(report.table.columns[i].key), row[i]);
    out.close();
  }
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
  line([&](size_t i) { return csv_text(report.table.columns[i].key); });
  for (const auto& row : report.table.rows)
    line([&](size_t i) { return csv_value(row[i]); });
  return text;
}

std::string deliver_report(const Report& report, const std::string& json, const std::string& csv,
                           const std::string& html) {
  if (!json.empty())
    if (std::string problem = deliver_text(json, report_as_json(report)); !problem.empty()) return problem;
  if (!csv.empty())
    if (std::string problem = deliver_text(csv, report_as_csv(report)); !problem.empty()) return problem;
  return html.empty() ? "" : deliver_page(html, report_as_html(report));
}

} // namespace dermis::tools
