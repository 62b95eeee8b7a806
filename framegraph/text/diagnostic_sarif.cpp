// Formats diagnostics as SARIF 2.1.0 (OASIS), which code hosts and editors show next to the
// affected lines.

#include "framegraph/text/diagnostic.hpp"
#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/utf8.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {

namespace {

std::string_view level_of(Severity severity) {
  return severity == Severity::error ? "error" : severity == Severity::warning ? "warning" : "note";
}

std::string printable(std::string_view text) {
  std::string out;
  append_printable(out, text, longest_text);
  return out;
}

// Returns a path as a URI reference (RFC 3986); relative paths stay relative.
std::string uri_of(std::string_view path) {
  constexpr std::string_view unreserved = "-._~/";
  std::string out = path.starts_with('/') ? "file://" : "";
  for (const char c : path) {
    const bool alphanumeric =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    if (alphanumeric || unreserved.find(c) != std::string_view::npos)
      out += c;
    else
      out += fmt::format("%{:02X}", static_cast<unsigned>(static_cast<uint8_t>(c)));
  }
  return out;
}

// Converts a column in bytes to the log's column in code points.
uint32_t column_in_code_points(const SourceFile& file, const SourceLocation& where) {
  size_t begin = 0;
  for (uint32_t line = 1; line < where.line; ++line) {
    const size_t end = file.text.find('\n', begin);
    if (end == std::string::npos) return where.column;
    begin = end + 1;
  }
  const std::string_view before = std::string_view(file.text).substr(begin, where.column - 1);
  if (before.size() + 1 < where.column) return where.column;
  return 1 + static_cast<uint32_t>(std::count_if(before.begin(), before.end(), [](char c) {
           return (static_cast<uint8_t>(c) & 0xc0) != 0x80;
         }));
}

// Writes the members of a location object; nothing without a file.
void write_location(JsonWriter& out, const Diagnostics& all, const SourceLocation& where) {
  if (!where.file.valid() || where.file.value >= all.files.size()) return;
  const SourceFile& file = all.files[where.file.value];
  out.key("physicalLocation").open_object();
  out.key("artifactLocation").open_object(true).member("uri", uri_of(file.name)).close();
  if (where.line > 0) {
    out.key("region").open_object(true).member("startLine", where.line);
    out.member("startColumn", column_in_code_points(file, where)).close();
  }
  out.close();
  if (where.pointer.empty()) return;
  out.key("logicalLocations").open_array(true).open_object();
  out.member("fullyQualifiedName", printable(where.pointer)).close().close();
}

void write_rule(JsonWriter& out, const DiagnosticInfo& info) {
  out.open_object().member("id", info.code).member("name", info.name);
  out.key("shortDescription").open_object(true).member("text", info.name).close();
  out.key("help").open_object(true).member("text", info.hint).close();
  out.key("defaultConfiguration")
      .open_object(true)
      .member("level", level_of(info.severity))
      .close();
  out.close();
}

void write_result(JsonWriter& out, const Diagnostics& all, const Diagnostic& one, uint64_t rule) {
  const DiagnosticInfo& info = diagnostic_info(one.id);
  std::string text = printable(one.text);
  if (!one.suggestion.empty()) text += "; " + printable(one.suggestion);
  out.open_object().member("ruleId", info.code).member("ruleIndex", rule);
  out.member("level", level_of(info.severity));
  out.key("message").open_object(true).member("text", text).close();
  out.key("locations").open_array();
  if (one.where.file.valid()) {
    out.open_object();
    write_location(out, all, one.where);
    out.close();
  }
  out.close().key("relatedLocations").open_array();
  for (size_t i = 0; i < one.related.size(); ++i) {
    out.open_object().member("id", static_cast<uint64_t>(i + 1));
    write_location(out, all, one.related[i].first);
    out.key("message")
        .open_object(true)
        .member("text", printable(one.related[i].second))
        .close()
        .close();
  }
  out.close().close();
}

} // namespace

std::string format_as_sarif(const Diagnostics& all, std::string_view tool_version) {
  std::vector<DiagnosticId> rules; // diagnostics that occur
  for (const Diagnostic& one : all.list)
    if (std::find(rules.begin(), rules.end(), one.id) == rules.end()) rules.push_back(one.id);
  std::sort(rules.begin(), rules.end());

  JsonWriter out;
  out.open_object().member("$schema", "https://json.schemastore.org/sarif-2.1.0.json");
  out.member("version", "2.1.0").key("runs").open_array().open_object();
  out.key("tool").open_object().key("driver").open_object();
  out.member("name", "dermis").member("version", tool_version).key("rules").open_array();
  for (const DiagnosticId id : rules)
    write_rule(out, diagnostic_info(id));
  out.close().close().close();
  out.member("columnKind", "unicodeCodePoints").key("results").open_array();
  for (const Diagnostic& one : all.list) {
    const auto rule = std::find(rules.begin(), rules.end(), one.id) - rules.begin();
    write_result(out, all, one, static_cast<uint64_t>(rule));
  }
  out.close().close().close().close();
  return std::move(out).finish();
}

} // namespace dermis
