#include "integration/tools/command/inspect/upgrade_edits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

constexpr std::string_view spaces = " \n\r\t";

} // namespace

TextEdits::TextEdits(const Document& source, std::string_view json) : document(source), text(json) {
  line_begins_.push_back(0);
  for (size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') line_begins_.push_back(i + 1);
}

std::string TextEdits::result() {
  std::sort(edits_.begin(), edits_.end(),
            [](const Edit& a, const Edit& b) { return a.begin < b.begin; });
  std::string out;
  size_t at = 0;
  for (const Edit& edit : edits_) {
    out.append(text.substr(at, edit.begin - at)).append(edit.text);
    at = edit.end;
  }
  return out.append(text.substr(at));
}

bool TextEdits::is_array(NodeId node) const {
  return node.valid() && document[node].kind == NodeKind::array;
}

NodeId TextEdits::string_at(NodeId object, std::string_view key) const {
  if (!object.valid() || document[object].kind != NodeKind::object) return {};
  const NodeId node = document.find(object, key);
  return node.valid() && document[node].kind == NodeKind::string ? node : NodeId{};
}

std::string_view TextEdits::at_port(NodeId pass, std::string_view side,
                                    std::string_view port) const {
  const NodeId value = string_at(document.find(pass, side), port);
  return value.valid() ? document.text(value) : std::string_view();
}

void TextEdits::replace(size_t begin, size_t end, std::string with) {
  edits_.push_back({begin, end, std::move(with)});
}

void TextEdits::rename(NodeId string, std::string_view name) {
  const size_t begin = document[string].offset;
  if (!name.empty()) replace(begin, end_of_string(begin), fmt::format("\"{}\"", name));
}

void TextEdits::rename_key(NodeId value, std::string_view name) {
  const size_t begin = key_begin(value);
  if (!name.empty()) replace(begin, end_of_string(begin), fmt::format("\"{}\"", name));
}

void TextEdits::add_member(NodeId object, std::string_view member) {
  const size_t begin = document[object].offset + 1;
  const bool empty = children(document, object).empty();
  replace(begin, begin, fmt::format(" {}{}", member, empty ? " " : ","));
}

void TextEdits::replace_member(NodeId value, std::string member) {
  replace(key_begin(value), end_of_value(value), std::move(member));
}

void TextEdits::remove_member(NodeId value) {
  size_t begin = key_begin(value), end = end_of_value(value);
  const size_t after = text.find_first_not_of(spaces, end);
  if (text[after] == ',') {
    end = text.find_first_not_of(" \t", after + 1);
    const size_t line = text.find_last_not_of(" \t", begin - 1) + 1;
    if (text[end] == '\n' && text[line - 1] == '\n') begin = line; // nothing else on the line
  } else if (const size_t before = text.find_last_not_of(spaces, begin - 1); text[before] == ',') {
    begin = before;
  }
  const std::string_view removed = text.substr(begin, end - begin);
  replace(begin, end,
          std::string(static_cast<size_t>(std::count(removed.begin(), removed.end(), '\n')), '\n'));
}

size_t TextEdits::key_begin(NodeId value) const {
  return line_begins_[document[value].key_line - 1] + document[value].key_column - 1;
}

size_t TextEdits::end_of_string(size_t begin) const {
  size_t end = begin + 1;
  while (text[end] != '"')
    end += text[end] == '\\' ? 2 : 1;
  return end + 1;
}

size_t TextEdits::end_of_value(NodeId value) const {
  size_t at = document[value].offset;
  if (text[at] == '"') return end_of_string(at);
  size_t depth = 0;
  for (;;) {
    const char c = text[at];
    if (c == '"') {
      at = end_of_string(at);
      continue;
    }
    if (c == '/') { // a comment
      at = text.find('\n', at);
      continue;
    }
    if (depth == 0 && (c == ',' || c == '}' || c == ']')) return at;
    ++at;
    if (c == '{' || c == '[') ++depth;
    if ((c == '}' || c == ']') && --depth == 0) return at;
  }
}

} // namespace dermis::tools
