#include "framegraph/text/reader.hpp"

#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"
#include "framegraph/text/utf8.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {

bool expect_kind(const Document& document, NodeId node, std::string_view what, NodeKind kind,
                 Diagnostics& diagnostics) {
  const NodeKind found = document[node].kind;
  // Every integer is a number.
  if (found == kind || (kind == NodeKind::real && found == NodeKind::integer)) return true;
  diagnostics.add(DiagnosticId::wrong_type, document.where(node),
                  fmt::format("{} must be {}; found {}", what, kind_name(kind), kind_name(found)));
  return false;
}

std::optional<std::string_view> read_string(const Document& document, NodeId node,
                                            std::string_view what, Diagnostics& diagnostics) {
  if (!expect_kind(document, node, what, NodeKind::string, diagnostics)) return std::nullopt;
  return document.text(node);
}

bool check_name(std::string_view name, std::string_view what, const SourceLocation& where,
                Diagnostics& diagnostics) {
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  if (name.size() > limits::name_bytes) {
    diagnostics.add(DiagnosticId::limit_exceeded, where,
                    fmt::format("{} has {} bytes; a name has at most {}", what, name.size(),
                                limits::name_bytes));
    return false;
  }
  if (!name.empty() && letter(name[0]) &&
      std::all_of(name.begin(), name.end(), [&](char c) { return letter(c) || digit(c); })) {
    return true;
  }
  diagnostics.add(DiagnosticId::bad_name, where,
                  fmt::format("{} is '{}'; a name is a letter or '_', then letters, digits or '_'",
                              what, shown_token(name)));
  return false;
}

std::optional<std::string_view> read_name(const Document& document, NodeId node,
                                          std::string_view what, Diagnostics& diagnostics) {
  const auto text = read_string(document, node, what, diagnostics);
  if (!text || !check_name(*text, what, document.where(node), diagnostics)) return std::nullopt;
  return text;
}

std::optional<bool> read_boolean(const Document& document, NodeId node, std::string_view what,
                                 Diagnostics& diagnostics) {
  if (!expect_kind(document, node, what, NodeKind::boolean, diagnostics)) return std::nullopt;
  return document[node].integer != 0;
}

std::optional<int64_t> read_integer(const Document& document, NodeId node, std::string_view what,
                                    int64_t minimum, int64_t maximum, Diagnostics& diagnostics) {
  if (!expect_kind(document, node, what, NodeKind::integer, diagnostics)) return std::nullopt;
  const int64_t value = document[node].integer;
  if (value >= minimum && value <= maximum) return value;
  diagnostics.add(
      DiagnosticId::out_of_range, document.where(node),
      fmt::format("{} is {}; expected a value in {} .. {}", what, value, minimum, maximum));
  return std::nullopt;
}

std::optional<double> read_number(const Document& document, NodeId node, std::string_view what,
                                  double minimum, double maximum, Diagnostics& diagnostics) {
  if (!expect_kind(document, node, what, NodeKind::real, diagnostics)) return std::nullopt;
  const double value = document[node].real;
  if (value >= minimum && value <= maximum) return value;
  diagnostics.add(
      DiagnosticId::out_of_range, document.where(node),
      fmt::format("{} is {}; expected a value in {} .. {}", what, value, minimum, maximum));
  return std::nullopt;
}

std::optional<uint32_t> read_word(const Document& document, NodeId node, std::string_view what,
                                  std::span<const std::string_view> words,
                                  Diagnostics& diagnostics) {
  if (!expect_kind(document, node, what, NodeKind::string, diagnostics)) return std::nullopt;
  const std::string_view text = document.text(node);
  const auto found = std::find(words.begin(), words.end(), text);
  if (found != words.end()) return static_cast<uint32_t>(found - words.begin());
  diagnostics
      .add(DiagnosticId::invalid_value, document.where(node),
           fmt::format("{} is '{}'; it must be {}", what, shown_token(text), list_words(words)))
      .suggestion = did_you_mean(text, words);
  return std::nullopt;
}

bool read_numbers(const Document& document, NodeId node, std::string_view what,
                  std::span<double> out, double minimum, double maximum, Diagnostics& diagnostics) {
  if (!expect_kind(document, node, what, NodeKind::array, diagnostics)) return false;
  if (document[node].child_count != out.size()) {
    diagnostics.add(DiagnosticId::wrong_type, document.where(node),
                    fmt::format("{} must have {} numbers; found {} values", what, out.size(),
                                document[node].child_count));
    return false;
  }
  std::vector<double> values;
  for (NodeId child : children(document, node)) {
    const auto value = read_number(document, child,
                                   fmt::format("number {} of {}", document[child].index + 1, what),
                                   minimum, maximum, diagnostics);
    if (value) values.push_back(*value);
  }
  if (values.size() != out.size()) return false;
  std::copy(values.begin(), values.end(), out.begin());
  return true;
}

NodeId find_misspelt(const Document& document, NodeId object, std::string_view key) {
  constexpr size_t max_looked_at = 256; // a hostile object may have hundreds of thousands of keys
  const std::string_view names[] = {key};
  size_t looked_at = 0;
  for (NodeId child = document[object].first_child; child.valid() && looked_at < max_looked_at;
       child = document[child].next, ++looked_at)
    if (!nearest(document.key(child), names).empty()) return child;
  return {};
}

std::vector<NodeId> children(const Document& document, NodeId node) {
  std::vector<NodeId> out;
  out.reserve(document[node].child_count);
  for (NodeId child = document[node].first_child; child.valid(); child = document[child].next)
    out.push_back(child);
  return out;
}

namespace {

// Returns the key that states another file type ("dermis": a graph); invalid if there is none.
NodeId find_other_type(const Document& document) {
  for (const NodeId node : children(document, document.root()))
    if ((document.key(node) == "dermis" || document.key(node).starts_with("dermis_")) &&
        document[node].kind == NodeKind::integer)
      return node;
  return {};
}

} // namespace

bool check_version(const Document& document, std::string_view key, int64_t supported,
                   Diagnostics& diagnostics) {
  if (!expect_kind(document, document.root(), "the file", NodeKind::object, diagnostics))
    return false;
  const NodeId node = document.find(document.root(), key);
  if (!node.valid()) {
    if (const NodeId other = find_other_type(document); other.valid()) {
      if (key == "dermis_pass_types" && document.key(other) == "dermis_kinds") {
        diagnostics.add(
            DiagnosticId::unsupported_version, document.where_key(other),
            "'dermis_kinds' is the key of version 1; `dermis upgrade FILE` converts the file");
        return false;
      }
      diagnostics.add(DiagnosticId::other_kind_of_file, document.where_key(other),
                      fmt::format("the file has the key '{}' where '{}' is expected",
                                  document.key(other), key));
      return false;
    }
    const NodeId misspelt = find_misspelt(document, document.root(), key);
    diagnostics
        .add(misspelt.valid() ? DiagnosticId::unknown_key : DiagnosticId::missing_key,
             misspelt.valid() ? document.where_key(misspelt) : document.where(document.root()),
             fmt::format("the file must state its format version, \"{}\": {}", key, supported))
        .suggestion = misspelt.valid() ? fmt::format("did you mean '{}'?", key) : std::string();
    return false;
  }
  if (!expect_kind(document, node, fmt::format("'{}', the format version,", key), NodeKind::integer,
                   diagnostics)) {
    return false;
  }
  const int64_t version = document[node].integer;
  if (version == supported) return true;
  const bool older = version >= 1 && version < supported;
  diagnostics.add(DiagnosticId::unsupported_version, document.where(node),
                  fmt::format("'{}' is {}; this library reads version {}{}", key, version,
                              supported, older ? "; `dermis upgrade FILE` converts the file" : ""));
  return false;
}

ObjectReader::ObjectReader(const Document& document, NodeId node, std::string what,
                           Diagnostics& diagnostics)
    : document_(document), diagnostics_(diagnostics), node_(node), what_(std::move(what)) {
  ok_ = expect_kind(document_, node_, what_, NodeKind::object, diagnostics_);
  requested_.push_back("note");
  if (!document_[node_].parent.valid()) requested_.push_back("$schema");
  if (!ok_) return;
  for (std::string_view key : requested_) {
    const NodeId child = document_.find(node_, key);
    if (child.valid())
      ok_ &= expect_kind(document_, child, describe(key), NodeKind::string, diagnostics_);
  }
}

std::string ObjectReader::describe(std::string_view key) const {
  return fmt::format("'{}' of {}", key, what_);
}

NodeId ObjectReader::find(std::string_view key, Need need) {
  requested_.push_back(key);
  if (document_[node_].kind != NodeKind::object) return {};
  const NodeId child = document_.find(node_, key);
  if (!child.valid() && need == Need::required) {
    ok_ = false;
    if (!diagnostics_.full()) missing_.push_back({key, diagnostics_.list.size()});
    diagnostics_.add(DiagnosticId::missing_key, document_.where(node_),
                     fmt::format("{} needs the key '{}'", what_, key));
  }
  return child;
}

NodeId ObjectReader::find(std::string_view key, Need need, NodeKind kind) {
  const NodeId child = find(key, need);
  if (!child.valid() || expect_kind(document_, child, describe(key), kind, diagnostics_))
    return child;
  ok_ = false;
  return {};
}

bool ObjectReader::has(std::string_view key) {
  return find(key, Need::optional).valid();
}
NodeId ObjectReader::any(std::string_view key, Need need) {
  return find(key, need);
}
NodeId ObjectReader::object(std::string_view key, Need need) {
  return find(key, need, NodeKind::object);
}

NodeId ObjectReader::array(std::string_view key, size_t minimum, size_t maximum, Need need) {
  const NodeId child = find(key, need, NodeKind::array);
  if (!child.valid()) return {};
  const size_t count = document_[child].child_count;
  if (count >= minimum && count <= maximum) return child;
  ok_ = false;
  diagnostics_.add(count > maximum ? DiagnosticId::limit_exceeded : DiagnosticId::out_of_range,
                   document_.where(child),
                   fmt::format("{} has {} entries; it must have {} .. {}", describe(key), count,
                               minimum, maximum));
  return {};
}

std::optional<std::string_view> ObjectReader::string(std::string_view key, Need need) {
  const NodeId child = find(key, need, NodeKind::string);
  if (!child.valid()) return std::nullopt;
  return document_.text(child);
}

std::optional<std::string_view> ObjectReader::name(std::string_view key, Need need) {
  const NodeId child = find(key, need);
  if (!child.valid()) return std::nullopt;
  const auto value = read_name(document_, child, describe(key), diagnostics_);
  ok_ &= value.has_value();
  return value;
}

std::optional<bool> ObjectReader::boolean(std::string_view key, Need need) {
  const NodeId child = find(key, need, NodeKind::boolean);
  if (!child.valid()) return std::nullopt;
  return document_[child].integer != 0;
}

std::optional<int64_t> ObjectReader::integer(std::string_view key, int64_t minimum, int64_t maximum,
                                             Need need) {
  const NodeId child = find(key, need);
  if (!child.valid()) return std::nullopt;
  const auto value = read_integer(document_, child, describe(key), minimum, maximum, diagnostics_);
  ok_ &= value.has_value();
  return value;
}

std::optional<double> ObjectReader::number(std::string_view key, double minimum, double maximum,
                                           Need need) {
  const NodeId child = find(key, need);
  if (!child.valid()) return std::nullopt;
  const auto value = read_number(document_, child, describe(key), minimum, maximum, diagnostics_);
  ok_ &= value.has_value();
  return value;
}

bool ObjectReader::numbers(std::string_view key, std::span<double> out, double minimum,
                           double maximum, Need need) {
  const NodeId child = find(key, need);
  if (!child.valid()) return false;
  const bool read =
      read_numbers(document_, child, describe(key), out, minimum, maximum, diagnostics_);
  ok_ &= read;
  return read;
}

std::optional<uint32_t> ObjectReader::word(std::string_view key,
                                           std::span<const std::string_view> words, Need need) {
  const NodeId child = find(key, need);
  if (!child.valid()) return std::nullopt;
  const auto value = read_word(document_, child, describe(key), words, diagnostics_);
  ok_ &= value.has_value();
  return value;
}

bool ObjectReader::finish() {
  if (document_[node_].kind != NodeKind::object) return false;
  for (NodeId child = document_[node_].first_child; child.valid(); child = document_[child].next) {
    const std::string_view key = document_.key(child);
    if (std::find(requested_.begin(), requested_.end(), key) != requested_.end()) continue;
    ok_ = false;
    // a hostile object may have hundreds of thousands of unknown keys
    if (diagnostics_.full()) break;
    const std::string_view meant = nearest(key, requested_);
    const auto missing = std::find_if(missing_.begin(), missing_.end(),
                                      [&](const Missing& one) { return one.key == meant; });
    Diagnostic fresh{DiagnosticId::unknown_key,
                     document_.where_key(child),
                     fmt::format("{} has no key '{}'", what_, shown_token(key)),
                     did_you_mean(key, requested_),
                     {}};
    if (missing != missing_.end()) { // one root cause: the key is misspelt, not missing
      diagnostics_.list[missing->diagnostic] = std::move(fresh);
      missing_.erase(missing);
    } else {
      diagnostics_.add(fresh.id, fresh.where, fresh.text).suggestion = fresh.suggestion;
    }
  }
  return ok_;
}

} // namespace dermis
