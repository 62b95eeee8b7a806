#include "framegraph/text/document.hpp"

#include "framegraph/text/limits.hpp"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <system_error>

namespace dermis {

std::string_view kind_name(NodeKind kind) {
  switch (kind) {
  case NodeKind::null:
    return "null";
  case NodeKind::boolean:
    return "a boolean";
  case NodeKind::integer:
    return "an integer";
  case NodeKind::real:
    return "a number";
  case NodeKind::string:
    return "a string";
  case NodeKind::array:
    return "an array";
  case NodeKind::object:
    return "an object";
  }
  return "";
}

std::string_view Document::text(NodeId id) const {
  const Node& node = nodes[id.value];
  return std::string_view(characters).substr(node.string_begin, node.string_size);
}

std::string_view Document::key(NodeId id) const {
  const Node& node = nodes[id.value];
  return std::string_view(characters).substr(node.key_begin, node.key_size);
}

NodeId Document::find(NodeId object, std::string_view name) const {
  if (nodes[object.value].kind != NodeKind::object) return {};
  for (NodeId child = nodes[object.value].first_child; child.valid();
       child = nodes[child.value].next) {
    if (key(child) == name) return child;
  }
  return {};
}

std::string Document::pointer(NodeId id) const {
  std::vector<NodeId> path; // from the value up to, but not including, the root
  for (NodeId at = id; nodes[at.value].parent.valid(); at = nodes[at.value].parent)
    path.push_back(at);
  std::string out;
  for (auto at = path.rbegin(); at != path.rend(); ++at) {
    const Node& node = nodes[at->value];
    const bool in_array = nodes[node.parent.value].kind == NodeKind::array;
    append_pointer_step(out, in_array ? fmt::to_string(node.index) : std::string(key(*at)));
  }
  return out;
}

void append_pointer_step(std::string& pointer, std::string_view key) {
  pointer += '/';
  for (const char c : key) { // RFC 6901 section 3
    if (c == '~') {
      pointer += "~0";
    } else if (c == '/') {
      pointer += "~1";
    } else {
      pointer += c;
    }
  }
}

SourceLocation Document::where(NodeId id) const {
  if (!origins.empty()) return sources[origins[id.value].source].where(origins[id.value].node);
  return {file, nodes[id.value].line, nodes[id.value].column, pointer(id)};
}

SourceLocation Document::where_key(NodeId id) const {
  if (!origins.empty()) {
    const Origin& origin = origins[id.value];
    const Document& source = sources[origin.source];
    return origin.key_node.valid() ? source.where(origin.key_node) : source.where_key(origin.node);
  }
  if (nodes[id.value].key_line == 0) return where(id);
  return {file, nodes[id.value].key_line, nodes[id.value].key_column, pointer(id)};
}

SourceLocation where_in_string(const Document& document, NodeId id, size_t decoded,
                               const Diagnostics& all) {
  if (!document.origins.empty()) {
    const Document::Origin& origin = document.origins[id.value];
    return where_in_string(document.sources[origin.source], origin.node, decoded, all);
  }
  SourceLocation out = document.where(id);
  const std::string_view text = all.files[document.file.value].text;
  size_t at = document[id].offset + 1; // after the opening quote
  for (size_t produced = 0; produced < decoded && at < text.size();) {
    if (text[at] != '\\') {
      ++at;
      ++produced;
      continue;
    }
    if (at + 1 >= text.size() || text[at + 1] != 'u') {
      at += 2;
      ++produced;
      continue;
    }
    uint32_t code = 0;
    for (size_t digit = at + 2; digit < std::min(at + 6, text.size()); ++digit) {
      const char c = text[digit];
      code = code * 16 + static_cast<uint32_t>(c <= '9' ? c - '0' : (c | 0x20) - 'a' + 10);
    }
    const bool pair = code >= 0xd800 && code < 0xe000; // two escapes, one code point of four bytes
    at += pair ? 12 : 6;
    produced += pair ? 4u : code < 0x80 ? 1u : code < 0x800 ? 2u : 3u;
  }
  out.column += static_cast<uint32_t>(at - document[id].offset);
  return out;
}

std::optional<Document> read_document(const std::string& path, Diagnostics& diagnostics) {
  const auto reject = [&](DiagnosticId id, const std::string& text) {
    diagnostics.files.push_back({path, ""});
    const FileId file{static_cast<uint32_t>(diagnostics.files.size() - 1)};
    diagnostics.add(id, {file, 0, 0, ""}, text);
    return std::nullopt;
  };
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    return reject(DiagnosticId::file_unreadable,
                  error && error != std::errc::no_such_file_or_directory
                      ? fmt::format("cannot read the file: {}", error.message())
                      : "the file does not exist");
  }
  // A pipe or a device could deliver data without end.
  if (!std::filesystem::is_regular_file(status))
    return reject(DiagnosticId::file_unreadable, "not a regular file");
  const uintmax_t size = std::filesystem::file_size(path, error);
  if (error)
    return reject(DiagnosticId::file_unreadable,
                  fmt::format("cannot read the file: {}", error.message()));
  if (size > limits::file_bytes) {
    return reject(
        DiagnosticId::limit_exceeded,
        fmt::format("the file has {} bytes; at most {} are read", size, limits::file_bytes));
  }
  std::string text(static_cast<size_t>(size), '\0');
  std::ifstream stream(path, std::ios::binary);
  if (!stream || (size > 0 && !stream.read(text.data(), static_cast<std::streamsize>(size)))) {
    return reject(DiagnosticId::file_unreadable, "the file cannot be opened or read to its end");
  }
  return parse_document(path, std::move(text), diagnostics);
}

} // namespace dermis
