// Formats diagnostics as text and as JSON. Quoted text may come from hostile files: unprintable
// characters are escaped, and excerpts fit in one terminal line.

#include "framegraph/text/diagnostic.hpp"
#include "framegraph/text/utf8.hpp"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <iterator>

namespace dermis {

namespace {

// bytes shown on either side of the column
constexpr size_t excerpt_before = 60, excerpt_after = 40;

std::string_view severity_name(Severity severity) {
  switch (severity) {
  case Severity::note:
    return "note";
  case Severity::warning:
    return "warning";
  case Severity::error:
    return "error";
  }
  return "";
}

std::string_view file_name(const Diagnostics& all, const SourceLocation& where) {
  return where.file.valid() && where.file.value < all.files.size()
             ? std::string_view(all.files[where.file.value].name)
             : std::string_view();
}

void append_place(std::string& out, const Diagnostics& all, const SourceLocation& where) {
  const std::string_view name = file_name(all, where);
  if (name.empty() && where.line == 0) return;
  append_printable(out, name.empty() ? "<text>" : name, longest_text);
  if (where.line > 0) fmt::format_to(std::back_inserter(out), ":{}:{}", where.line, where.column);
  out += ": ";
}

bool is_continuation(char c) {
  return (static_cast<uint8_t>(c) & 0xc0) == 0x80;
}

// Appends "\n   12 | the line\n      |     ^", or nothing if the text is not available.
void append_excerpt(std::string& out, const Diagnostics& all, const SourceLocation& where) {
  if (!where.file.valid() || where.file.value >= all.files.size() || where.line == 0 ||
      where.column == 0)
    return;
  const std::string_view text = all.files[where.file.value].text;
  size_t begin = 0;
  for (uint32_t line = 1; line < where.line; ++line) {
    const size_t end = text.find('\n', begin);
    if (end == std::string_view::npos) return;
    begin = end + 1;
  }
  std::string_view line = text.substr(begin, text.find('\n', begin) - begin);
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  const size_t column = where.column - 1;
  if (line.empty() || column > line.size()) return;
  size_t first = column > excerpt_before ? column - excerpt_before : 0;
  while (first < column && is_continuation(line[first]))
    ++first;
  size_t last = std::min(line.size(), column + excerpt_after);
  while (last < line.size() && is_continuation(line[last]))
    ++last;

  // Uses one terminal column per code point, so that the caret is below its character.
  const auto one_column_each = [](std::string_view part) {
    std::string columns;
    for (size_t at = 0; at < part.size();) {
      const size_t bytes = std::max<size_t>(utf8_sequence_bytes(part.substr(at, 4)), 1);
      const std::string_view one = part.substr(at, bytes);
      if (find_invalid_utf8(one) != std::string_view::npos)
        columns += '?';
      else
        columns += acts_on_terminal(one) ? std::string_view(" ") : one;
      at += bytes;
    }
    return columns;
  };
  const std::string before =
      (first > 0 ? "..." : "") + one_column_each(line.substr(first, column - first));
  const std::string after =
      one_column_each(line.substr(column, last - column)) + (last < line.size() ? "..." : "");
  const auto caret_column =
      std::count_if(before.begin(), before.end(), [](char c) { return !is_continuation(c); });
  fmt::format_to(std::back_inserter(out), "\n{:>6} | {}{}\n       | {:{}}^", where.line, before,
                 after, "", caret_column);
}

void append_json_string(std::string& out, std::string_view text) {
  out += '"';
  for (size_t at = 0; at < text.size();) {
    const size_t length = utf8_sequence_bytes(text.substr(at, 4));
    const char c = text[at];
    if (length == 0) {
      out += "\\ufffd";
    } else if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<uint8_t>(c) < 0x20) {
      fmt::format_to(std::back_inserter(out), "\\u{:04x}", static_cast<unsigned>(c));
    } else {
      out += text.substr(at, length);
    }
    at += length == 0 ? 1 : length;
  }
  out += '"';
}

void append_json_place(std::string& out, const Diagnostics& all, const SourceLocation& where) {
  out += "\"file\": ";
  append_json_string(out, file_name(all, where));
  fmt::format_to(std::back_inserter(out),
                 ", \"line\": {}, \"column\": {}, \"pointer\": ", where.line, where.column);
  append_json_string(out, where.pointer);
}

} // namespace

std::string format_for_people(const Diagnostics& all, const Diagnostic& one, bool excerpt) {
  const DiagnosticInfo& info = diagnostic_info(one.id);
  std::string out;
  append_place(out, all, one.where);
  fmt::format_to(std::back_inserter(out), "{}[{} {}]: ", severity_name(info.severity), info.code,
                 info.name);
  append_printable(out, one.text, longest_text);
  if (!one.suggestion.empty()) {
    out += "; ";
    append_printable(out, one.suggestion, longest_text);
  }
  if (!one.where.pointer.empty()) {
    out += " (at ";
    append_printable(out, one.where.pointer, longest_text);
    out += ')';
  }
  if (excerpt) append_excerpt(out, all, one.where);
  for (const auto& [where, text] : one.related) {
    out += "\n  ";
    append_place(out, all, where);
    append_printable(out, text, longest_text);
    if (excerpt) append_excerpt(out, all, where);
  }
  out += "\n  ";
  out += info.hint;
  return out;
}

std::string format_as_json(const Diagnostics& all) {
  std::string out = "[";
  for (size_t i = 0; i < all.list.size(); ++i) {
    const Diagnostic& one = all.list[i];
    const DiagnosticInfo& info = diagnostic_info(one.id);
    fmt::format_to(std::back_inserter(out),
                   "{}\n  {{ \"id\": \"{}\", \"name\": \"{}\", \"severity\": \"{}\", ",
                   i == 0 ? "" : ",", info.code, info.name, severity_name(info.severity));
    append_json_place(out, all, one.where);
    out += ", \"text\": ";
    append_json_string(out, one.text);
    out += ", \"suggestion\": ";
    append_json_string(out, one.suggestion);
    out += ", \"hint\": ";
    append_json_string(out, info.hint);
    out += ", \"related\": [";
    for (size_t j = 0; j < one.related.size(); ++j) {
      out += j == 0 ? "{ " : ", { ";
      append_json_place(out, all, one.related[j].first);
      out += ", \"text\": ";
      append_json_string(out, one.related[j].second);
      out += " }";
    }
    out += "] }";
  }
  out += all.list.empty() ? "]" : "\n]";
  return out;
}

} // namespace dermis
