// Converts the SAX events of the JSON parser into nodes. No other file depends on the parser.

#include "framegraph/text/counting_iterator.hpp"
#include "framegraph/text/document.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/utf8.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace dermis {

namespace {

constexpr int out_of_range_exception = 406; // nlohmann: "number overflow"

TextPosition locate(std::string_view text, size_t offset) {
  TextPosition out;
  out.offset = std::min(offset, text.size());
  for (size_t i = 0; i < out.offset; ++i) {
    ++out.column;
    if (text[i] == '\n') {
      ++out.line;
      out.column = 1;
    }
  }
  return out;
}

class NodeBuilder {
public:
  using number_integer_t = nlohmann::json::number_integer_t;
  using number_unsigned_t = nlohmann::json::number_unsigned_t;
  using number_float_t = nlohmann::json::number_float_t;
  using string_t = nlohmann::json::string_t;
  using binary_t = nlohmann::json::binary_t;

  NodeBuilder(std::string_view text, const TextCursor& cursor, Document& document,
              Diagnostics& diagnostics)
      : text_(text), cursor_(cursor), document_(document), diagnostics_(diagnostics) {}

  bool null() { return add(NodeKind::null) != nullptr; }
  bool boolean(bool value) {
    Node* node = add(NodeKind::boolean);
    if (node != nullptr) node->integer = value ? 1 : 0;
    return node != nullptr;
  }
  bool number_integer(number_integer_t value) {
    Node* node = add(NodeKind::integer);
    if (node == nullptr) return false;
    node->integer = value;
    node->real = static_cast<double>(value);
    return true;
  }
  bool number_unsigned(number_unsigned_t value) {
    if (value > static_cast<number_unsigned_t>(INT64_MAX))
      return reject_integer(fmt::to_string(value));
    return number_integer(static_cast<number_integer_t>(value));
  }
  bool number_float(number_float_t value, const string_t& token) {
    const std::string_view text = number_text(token.size());
    if (text.find_first_of(".eE") == std::string_view::npos) return reject_integer(text);
    Node* node = add(NodeKind::real);
    if (node == nullptr) return false;
    // The parser converts with strtod, which depends on the host's locale; from_chars does not.
    // from_chars may reject denormals, for which the parser's value is used.
    double exact = 0.0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), exact);
    node->real = result.ec == std::errc() ? exact : value;
    return true;
  }
  bool string(string_t& value) {
    if (!check_no_nul(value)) return false;
    const uint32_t begin = keep(value);
    Node* node = add(NodeKind::string);
    if (node == nullptr) return false;
    node->string_begin = begin;
    node->string_size = static_cast<uint32_t>(value.size());
    return true;
  }
  bool binary(binary_t&) { return false; } // not part of JSON text
  bool start_object(size_t) { return open(NodeKind::object); }
  bool start_array(size_t) { return open(NodeKind::array); }
  bool key(string_t& value);
  bool end_object();
  bool end_array() {
    open_.pop_back();
    return true;
  }
  bool parse_error(size_t position, const std::string& last_token,
                   const nlohmann::detail::exception& exception);

  bool failed() const { return failed_; }

  // Returns the pointer of the value that the next characters belong to: of the member whose key
  // was read, else of the open object or array.
  std::string open_pointer() const {
    if (open_.empty()) return {};
    std::string pointer = document_.pointer(open_.back().node);
    if (key_is_pending_)
      append_pointer_step(pointer,
                          std::string_view(document_.characters).substr(key_begin_, key_size_));
    return pointer;
  }
  // Same, but in an array the pointer of its next element.
  std::string value_pointer() const {
    std::string pointer = open_pointer();
    if (open_.empty()) return pointer;
    const Node& inside = document_[open_.back().node];
    if (inside.kind == NodeKind::array)
      append_pointer_step(pointer, fmt::to_string(inside.child_count));
    return pointer;
  }

private:
  struct Open {
    NodeId node, last_child;
  };

  bool reject(DiagnosticId id, TextPosition position, std::string text, std::string pointer) {
    diagnostics_.add(id, {document_.file, position.line, position.column, std::move(pointer)},
                     std::move(text));
    failed_ = true;
    return false;
  }
  bool reject_value(DiagnosticId id, std::string text) {
    return reject(id, cursor_.value_position(), std::move(text), value_pointer());
  }
  bool reject_integer(std::string_view token) {
    return reject_value(
        DiagnosticId::integer_precision,
        fmt::format("the integer {} does not fit in 64 signed bits", shown_token(token)));
  }
  bool check_no_nul(std::string_view value) {
    if (value.find('\0') == std::string_view::npos) return true;
    return reject_value(DiagnosticId::syntax, "strings may not contain \\u0000");
  }
  // Returns the last number as the file has it. The parser's copy of it, of equal size, has the
  // decimal point of the host's locale.
  std::string_view number_text(size_t size) const {
    const size_t at = cursor_.value_position().offset;
    const std::string_view rest = text_.substr(at);
    // The parser has read one character beyond the number, which may begin the next value.
    const bool is_next = rest.empty() || (rest[0] != '-' && (rest[0] < '0' || rest[0] > '9'));
    return text_.substr(is_next ? at - std::min(at, size) : at, size);
  }
  uint32_t keep(std::string_view characters) {
    const auto begin = static_cast<uint32_t>(document_.characters.size());
    document_.characters += characters;
    return begin;
  }
  bool open(NodeKind kind) {
    if (add(kind) == nullptr) return false;
    open_.push_back({{static_cast<uint32_t>(document_.nodes.size() - 1)}, {}});
    return true;
  }
  Node* add(NodeKind kind);

  std::string_view text_;
  const TextCursor& cursor_;
  Document& document_;
  Diagnostics& diagnostics_;
  std::vector<Open> open_;
  TextPosition key_position_;
  uint32_t key_begin_ = 0, key_size_ = 0;
  bool key_is_pending_ = false; // the key's value has not begun
  bool failed_ = false;
};

Node* NodeBuilder::add(NodeKind kind) {
  const TextPosition position = cursor_.value_position();
  if (document_.nodes.size() >= limits::nodes) {
    reject_value(DiagnosticId::limit_exceeded,
                 fmt::format("the document has more than {} values", limits::nodes));
    return nullptr;
  }
  const NodeId id{static_cast<uint32_t>(document_.nodes.size())};
  Node& node = document_.nodes.emplace_back();
  node.kind = kind;
  node.offset = static_cast<uint32_t>(position.offset);
  node.line = position.line;
  node.column = position.column;
  if (open_.empty()) return &node;
  Open& inside = open_.back();
  Node& parent = document_.nodes[inside.node.value];
  node.parent = inside.node;
  node.index = parent.child_count++;
  if (inside.last_child.valid()) {
    document_.nodes[inside.last_child.value].next = id;
  } else {
    parent.first_child = id;
  }
  inside.last_child = id;
  if (parent.kind == NodeKind::object) {
    node.key_line = key_position_.line;
    node.key_column = key_position_.column;
    node.key_begin = key_begin_;
    node.key_size = key_size_;
    key_is_pending_ = false;
  }
  return &node;
}

bool NodeBuilder::key(string_t& value) {
  key_position_ = cursor_.value_position();
  if (value.size() > limits::key_bytes) {
    return reject_value(DiagnosticId::limit_exceeded,
                        fmt::format("this key has {} bytes; at most {} are allowed", value.size(),
                                    limits::key_bytes));
  }
  if (!check_no_nul(value)) return false;
  key_begin_ = keep(value);
  key_size_ = static_cast<uint32_t>(value.size());
  key_is_pending_ = true;
  return true;
}

bool NodeBuilder::end_object() {
  const NodeId object = open_.back().node;
  open_.pop_back();
  // Sorts instead of comparing pairs, because a hostile object may have hundreds of thousands of
  // keys.
  std::vector<NodeId> members;
  for (NodeId child = document_[object].first_child; child.valid(); child = document_[child].next) {
    members.push_back(child);
  }
  std::sort(members.begin(), members.end(), [&](NodeId a, NodeId b) {
    const std::string_view left = document_.key(a), right = document_.key(b);
    return left != right ? left < right : a < b;
  });
  std::vector<std::pair<NodeId, NodeId>> repeated; // the repetition, the first
  for (size_t i = 1, first = 0; i < members.size(); ++i) {
    if (document_.key(members[i]) != document_.key(members[first])) {
      first = i;
    } else {
      repeated.emplace_back(members[i], members[first]);
    }
  }
  std::sort(repeated.begin(), repeated.end());
  for (const auto& [again, first] : repeated) {
    failed_ = true;
    if (diagnostics_.full()) break;
    Diagnostic& one = diagnostics_.add(
        DiagnosticId::duplicate_key, document_.where_key(again),
        fmt::format("the key '{}' appears twice in one object", shown_token(document_.key(again))));
    one.related.emplace_back(document_.where_key(first), "first given here");
  }
  return true;
}

bool NodeBuilder::parse_error(size_t position, const std::string& last_token,
                              const nlohmann::detail::exception& exception) {
  failed_ = true;
  if (cursor_.early_end() != EarlyEnd::none) return false; // the caller reports the limit
  if (exception.id == out_of_range_exception) {
    return reject_value(DiagnosticId::out_of_range,
                        fmt::format("the number {} is beyond the range of double precision",
                                    shown_token(number_text(last_token.size()))));
  }
  // Format: "[json.exception...] parse error at line L, column C: syntax error while parsing W -
  // what; last read: '...'"
  std::string_view what = exception.what();
  std::string_view where_in_grammar;
  constexpr std::string_view while_parsing = "while parsing ", separator = " - ",
                             last_read = "; last read: '";
  if (const size_t begin = what.find(while_parsing); begin != std::string_view::npos) {
    what.remove_prefix(begin + while_parsing.size());
    const size_t dash = what.find(separator);
    where_in_grammar = what.substr(0, dash);
    what = dash == std::string_view::npos ? std::string_view("malformed text")
                                          : what.substr(dash + separator.size());
  }
  std::string reason(what.substr(0, what.find(last_read)));
  if (const size_t begin = what.find(last_read); begin != std::string_view::npos) {
    // Text after the quoted token: "; expected ...".
    const size_t end = what.rfind("'; expected ");
    if (end != std::string_view::npos && end > begin) reason += what.substr(end + 1);
  }
  // Names the two most common mistakes. An empty object or array is well-formed.
  const bool in_array = !open_.empty() && document_[open_.back().node].kind == NodeKind::array;
  if ((where_in_grammar == "object key" && reason.starts_with("unexpected '}'")) ||
      (where_in_grammar == "value" && in_array && reason.starts_with("unexpected ']'")))
    reason += "; remove the comma before it";
  else if ((where_in_grammar == "object" && reason.starts_with("unexpected string literal")) ||
           (where_in_grammar == "array" && !reason.starts_with("unexpected '}'") &&
            !reason.starts_with("unexpected ':'") &&
            !reason.starts_with("unexpected end of input")))
    reason += "; add a comma before it";
  const bool unexpected = reason.rfind("unexpected", 0) == 0;
  const size_t last = position == 0 ? 0 : position - 1;
  TextPosition place = locate(text_, last);
  if (unexpected && last < text_.size()) place = cursor_.token_position_before(position);
  return reject(
      DiagnosticId::syntax, place,
      fmt::format("malformed {}: {}", where_in_grammar.empty() ? "JSON" : where_in_grammar, reason),
      open_pointer());
}

void report_early_end(const TextCursor& cursor, const Document& document,
                      const NodeBuilder& builder, Diagnostics& diagnostics) {
  const TextPosition position = cursor.early_end_position();
  SourceLocation where{document.file, position.line, position.column, builder.open_pointer()};
  const auto limit = [&](std::string text) {
    // An object or array that is nested too deep is open already; a string or number is not.
    if (cursor.early_end() != EarlyEnd::deep_nesting) where.pointer = builder.value_pointer();
    diagnostics.add(DiagnosticId::limit_exceeded, where, std::move(text));
  };
  switch (cursor.early_end()) {
  case EarlyEnd::none:
    break;
  case EarlyEnd::nul_byte:
    diagnostics.add(DiagnosticId::syntax, where, "the text contains a NUL byte");
    break;
  case EarlyEnd::block_comment:
    diagnostics.add(DiagnosticId::syntax, where,
                    "block comments are not allowed; begin each line with //");
    break;
  case EarlyEnd::long_string:
    limit(fmt::format("this string is longer than {} bytes", limits::string_bytes));
    break;
  case EarlyEnd::long_number:
    limit(fmt::format("this number or word is longer than {} bytes", limits::number_bytes));
    break;
  case EarlyEnd::deep_nesting:
    limit(fmt::format("objects and arrays are nested more than {} deep", limits::nesting));
    break;
  }
}

} // namespace

std::optional<Document> parse_document(std::string name, std::string text,
                                       Diagnostics& diagnostics) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (text.rfind(byte_order_mark, 0) == 0) text.erase(0, byte_order_mark.size());
  Document document;
  document.file = {static_cast<uint32_t>(diagnostics.files.size())};
  const size_t size = text.size();
  if (size > limits::file_bytes) text.clear();
  diagnostics.files.push_back({std::move(name), std::move(text)});
  if (size > limits::file_bytes) {
    diagnostics.add(
        DiagnosticId::limit_exceeded, {document.file, 0, 0, ""},
        fmt::format("the text has {} bytes; at most {} are read", size, limits::file_bytes));
    return std::nullopt;
  }
  const std::string_view all = diagnostics.files.back().text;
  if (all.starts_with("DERMPLAN")) {
    diagnostics.add(DiagnosticId::other_kind_of_file, {document.file, 1, 1, ""},
                    "this is a saved plan; `dermis plan` reads those");
    return std::nullopt;
  }
  if (all.starts_with(byte_order_mark)) { // the JSON parser would ignore it
    diagnostics.add(DiagnosticId::syntax, {document.file, 1, 1, ""},
                    "the text begins with more than one byte order mark");
    return std::nullopt;
  }
  if (const size_t bad = find_invalid_utf8(all); bad != std::string_view::npos) {
    const TextPosition position = locate(all, bad);
    diagnostics.add(DiagnosticId::invalid_utf8, {document.file, position.line, position.column, ""},
                    fmt::format("the byte 0x{:02x} does not continue well-formed UTF-8",
                                static_cast<unsigned>(static_cast<uint8_t>(all[bad]))));
    return std::nullopt;
  }
  TextCursor cursor(all);
  NodeBuilder builder(all, cursor, document, diagnostics);
  bool parsed = false;
  try {
    parsed = nlohmann::json::sax_parse(CountingIterator(cursor), CountingIterator(), &builder,
                                       nlohmann::json::input_format_t::json, true, true);
  } catch (const std::bad_alloc&) {
    throw; // not the text's fault; the caller reports it as out of memory
  } catch (const std::exception& exception) {
    diagnostics.add(DiagnosticId::syntax, {document.file, 0, 0, ""},
                    fmt::format("the JSON parser failed: {}", exception.what()));
  }
  report_early_end(cursor, document, builder, diagnostics);
  if (!parsed || builder.failed() || cursor.early_end() != EarlyEnd::none || document.nodes.empty())
    return std::nullopt;
  return document;
}

} // namespace dermis
