#include "integration/tools/command/inspect/upgrade_edits.hpp"

#include "framegraph/text/json_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

constexpr std::string_view spaces = " \n\r\t";

// Returns the text as a JSON string with its quotes.
std::string quoted(std::string_view text) {
  JsonWriter json;
  json.value(text);
  std::string line = std::move(json).finish();
  line.pop_back(); // the newline
  return line;
}

} // namespace

TextEdits::TextEdits(const Document& source, std::string_view json) : document(source), text(json) {
  line_begins_.push_back(0);
  for (size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') line_begins_.push_back(i + 1);
}

std::string TextEdits::result() {
  for (const size_t begin : removed_last_)
    remove_comma_before(begin);
  removed_last_.clear();
  std::stable_sort(edits_.begin(), edits_.end(),
                   [](const Edit& a, const Edit& b) { return a.begin < b.begin; });
  std::string out;
  size_t at = 0;
  for (const Edit& edit : edits_) {
    const size_t begin = std::max(edit.begin, at); // removed members share the blanks between them
    out.append(text.substr(at, begin - at)).append(edit.text);
    at = std::max(at, edit.end);
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
  if (!name.empty()) replace(begin, end_of_string(begin), quoted(name));
}

void TextEdits::rename_key(NodeId value, std::string_view name) {
  const size_t begin = key_begin(value);
  if (!name.empty()) replace(begin, end_of_string(begin), quoted(name));
}

void TextEdits::add_member(NodeId object, std::string_view member) {
  const size_t begin = document[object].offset + 1;
  const bool empty = children(document, object).empty();
  replace(begin, begin, fmt::format(" {}", member));
  replace(begin, begin, empty ? " " : ",");
}

void TextEdits::replace_member(NodeId value, std::string member) {
  replace(key_begin(value), end_of_value(value), std::move(member));
}

void TextEdits::remove_member(NodeId value) {
  const size_t begin = key_begin(value), value_end = end_of_value(value);
  const size_t line = text.find_last_not_of(" \t", begin - 1) + 1; // before the blanks
  const size_t after = next_token(value_end);
  const auto alone = [&](size_t end) { return text[end] == '\n' && text[line - 1] == '\n'; };
  if (text[after] != ',') {
    remove(line, value_end);
    removed_last_.push_back(begin);
  } else if (text.find_first_not_of(spaces, value_end) != after) { // a comment before the comma
    remove(begin, value_end);
    remove(after, after + 1);
  } else {
    const size_t end = text.find_first_not_of(" \t", after + 1);
    remove(alone(end) ? line : begin, end);
  }
}

void TextEdits::remove(size_t begin, size_t end) {
  const std::string_view removed = text.substr(begin, end - begin);
  replace(begin, end,
          std::string(static_cast<size_t>(std::count(removed.begin(), removed.end(), '\n')), '\n'));
}

void TextEdits::remove_comma_before(size_t begin) {
  const auto covers = [](size_t at) {
    return [at](const Edit& edit) { return edit.begin <= at && at < edit.end; };
  };
  size_t at = separator_before(begin);
  while (text[at] == ',' && std::any_of(edits_.begin(), edits_.end(), covers(at)))
    at = separator_before(at); // the comma of a removed member
  if (text[at] == ',') return replace(at, at + 1, "");
  std::erase_if(edits_, [&](const Edit& edit) { // that of add_member
    return edit.begin == at + 1 && edit.end == at + 1 && edit.text == ",";
  });
}

size_t TextEdits::next_token(size_t at) const {
  for (;;) {
    at = text.find_first_not_of(spaces, at);
    if (text[at] != '/') return at;
    at = text.find_first_of("\r\n", at); // a comment
  }
}

size_t TextEdits::separator_before(size_t begin) const {
  std::vector<size_t> separators; // one per open object or array
  for (size_t at = 0; at < begin;) {
    const char c = text[at];
    if (c == '"') {
      at = end_of_string(at);
      continue;
    }
    if (c == '/') {
      at = text.find_first_of("\r\n", at);
      continue;
    }
    if (c == '{' || c == '[') separators.push_back(at);
    if (c == '}' || c == ']') separators.pop_back();
    if (c == ',') separators.back() = at;
    ++at;
  }
  return separators.back();
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
      at = text.find_first_of("\r\n", at);
      continue;
    }
    if (depth == 0 && (c == ',' || c == '}' || c == ']')) return at;
    ++at;
    if (c == '{' || c == '[') ++depth;
    if ((c == '}' || c == ']') && --depth == 0) return at;
  }
}

} // namespace dermis::tools
