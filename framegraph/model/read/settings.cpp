// Reads "settings": typed values that the host may change at run time.

#include "framegraph/model/expression_lexer.hpp"
#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace dermis {

namespace {

constexpr std::string_view type_keys[] = {"bool", "int", "real", "enum", "choice"};
constexpr SettingType types[] = {SettingType::boolean, SettingType::integer, SettingType::real,
                                 SettingType::enumeration, SettingType::choice};

// Settings reach kernels as 32-bit push constants.
constexpr int64_t min_integer = std::numeric_limits<int32_t>::min();
constexpr int64_t max_integer = std::numeric_limits<int32_t>::max();
constexpr double max_real = std::numeric_limits<float>::max();

// Checks minimum <= value <= maximum. The numbers are already valid individually.
template <class Number>
bool check_range(GraphReader& reader, const ObjectReader& object, std::string_view key,
                 Number minimum, Number maximum, Number value) {
  const auto where = [&](std::string_view which) {
    return reader.document.where(reader.document.find(object.node(), which));
  };
  if (minimum > maximum) {
    reader
        .error(DiagnosticId::setting_range, where("max"),
               fmt::format("{} has the maximum {}, which is less than its minimum {}",
                           object.what(), maximum, minimum))
        .related.emplace_back(where("min"), "the minimum is declared here");
    return false;
  }
  if (value >= minimum && value <= maximum) return true;
  reader
      .error(DiagnosticId::setting_range, where(key),
             fmt::format("the default of {} is {}, outside its own range {} .. {}", object.what(),
                         value, minimum, maximum))
      .related.emplace_back(where(value < minimum ? "min" : "max"),
                            value < minimum ? "the minimum is declared here"
                                            : "the maximum is declared here");
  return false;
}

bool read_integer_setting(GraphReader& reader, ObjectReader& object, SettingDeclaration& out) {
  const auto minimum = object.integer("min", min_integer, max_integer);
  const auto maximum = object.integer("max", min_integer, max_integer);
  const auto value = object.integer("int", min_integer, max_integer);
  if (!minimum || !maximum || !value) return false;
  out.minimum = static_cast<double>(*minimum);
  out.maximum = static_cast<double>(*maximum);
  out.default_value = {SettingType::integer, *value, 0.0};
  return check_range(reader, object, "int", *minimum, *maximum, *value);
}

bool read_real_setting(GraphReader& reader, ObjectReader& object, SettingDeclaration& out) {
  const auto minimum = object.number("min", -max_real, max_real);
  const auto maximum = object.number("max", -max_real, max_real);
  const auto value = object.number("real", -max_real, max_real);
  if (!minimum || !maximum || !value) return false;
  out.minimum = *minimum;
  out.maximum = *maximum;
  out.default_value = {SettingType::real, 0, *value};
  return check_range(reader, object, "real", *minimum, *maximum, *value);
}

bool read_default(GraphReader& reader, ObjectReader& object, std::string_view key,
                  SettingDeclaration& out) {
  const auto word = object.string("default", Need::optional);
  out.default_value = {out.type, 0, 0.0};
  if (!word) return object.ok();
  const auto found = std::find(out.options.begin(), out.options.end(), *word);
  out.default_value.integer = found - out.options.begin();
  if (found != out.options.end()) return true;
  const std::vector<std::string_view> words(out.options.begin(), out.options.end());
  Diagnostic& one =
      reader.error(DiagnosticId::setting_range,
                   reader.document.where(reader.document.find(object.node(), "default")),
                   fmt::format("the default of {} is '{}', which is not one of its options {}",
                               object.what(), *word, list_words(words)));
  one.suggestion = did_you_mean(*word, words);
  one.related.emplace_back(reader.document.where(reader.document.find(object.node(), key)),
                           "the options are listed here");
  return false;
}

// Reads a name or a whole number such as "25". Options are always quoted.
std::optional<std::string_view> read_option(GraphReader& reader, NodeId node,
                                            std::string_view what) {
  const auto text = read_string(reader.document, node, what, reader.diagnostics);
  if (!text) return std::nullopt;
  const bool number = !text->empty() && text->size() <= limits::name_bytes &&
                      text->find_first_not_of("0123456789") == std::string_view::npos;
  if (number || check_name(*text, what, reader.document.where(node), reader.diagnostics))
    return text;
  return std::nullopt;
}

void read_options(GraphReader& reader, ObjectReader& object, std::string_view key,
                  SettingDeclaration& out, bool& ok) {
  object.any("default"); // marks the key as known, even if reading fails below
  const NodeId list = object.array(key, 1, limits::options);
  if (!list.valid()) return;
  for (NodeId node : children(reader.document, list)) {
    const auto option = read_option(reader, node, fmt::format("an option of {}", object.what()));
    ok &= option.has_value();
    if (!option) continue;
    if (std::find(out.options.begin(), out.options.end(), *option) != out.options.end()) {
      ok = false;
      reader.error(DiagnosticId::duplicate_name, reader.document.where(node),
                   fmt::format("{} lists the option '{}' twice", object.what(), *option));
      continue;
    }
    out.options.emplace_back(*option);
  }
  if (ok) ok = read_default(reader, object, key, out);
}

// Reports a setting without a type key, and suggests the type key that is closest to an unknown
// key.
void report_untyped(GraphReader& reader, const ObjectReader& object) {
  constexpr std::string_view other_keys[] = {"min", "max", "default", "by", "unit", "note"};
  const std::string text = fmt::format("{} must state its type and value with one of the keys {}",
                                       object.what(), list_words(type_keys));
  for (const NodeId child : children(reader.document, object.node())) {
    const std::string_view key = reader.document.key(child);
    const bool known =
        std::find(std::begin(other_keys), std::end(other_keys), key) != std::end(other_keys);
    const std::string suggestion = known ? std::string() : did_you_mean(key, type_keys);
    if (suggestion.empty()) continue;
    reader.error(DiagnosticId::unknown_key, reader.document.where_key(child), text).suggestion =
        suggestion;
    return;
  }
  reader.error(DiagnosticId::missing_key, reader.document.where(object.node()), text);
}

bool read_setting(GraphReader& reader, NodeId node, SettingId id, SettingDeclaration& out) {
  ObjectReader object(reader.document, node, fmt::format("setting '{}'", out.name),
                      reader.diagnostics);
  if (!object.ok()) return false;
  size_t found = std::size(type_keys);
  for (size_t i = 0; i < std::size(type_keys); ++i) {
    if (!reader.document.find(node, type_keys[i]).valid()) continue;
    found = i;
    break;
  }
  if (found == std::size(type_keys)) {
    report_untyped(reader, object);
    return false;
  }
  bool ok = true;
  // marks the key as known, even if reading fails below
  object.any(type_keys[found], Need::optional);
  out.type = types[found];
  out.note = note_of(reader.document, node);
  out.unit = object.string("unit", Need::optional).value_or("");
  switch (out.type) {
  case SettingType::boolean:
    out.default_value = {SettingType::boolean, object.boolean("bool").value_or(false) ? 1 : 0, 0.0};
    out.maximum = 1.0;
    break;
  case SettingType::integer:
    ok &= read_integer_setting(reader, object, out);
    break;
  case SettingType::real:
    ok &= read_real_setting(reader, object, out);
    break;
  case SettingType::choice: {
    constexpr std::string_view who[] = {"host", "budget"};
    out.by_budget = object.word("by", who, Need::optional).value_or(0) == 1;
    if (const NodeId requirements = object.object("requires", Need::optional); requirements.valid())
      reader.option_requirements.emplace_back(id, requirements);
    read_options(reader, object, "choice", out, ok);
    break;
  }
  case SettingType::enumeration:
    read_options(reader, object, "enum", out, ok);
    break;
  }
  return object.finish() && ok;
}

} // namespace

void read_settings(GraphReader& reader, NodeId settings) {
  if (!settings.valid()) return;
  const std::vector<NodeId> nodes = children(reader.document, settings);
  if (nodes.size() > limits::settings) {
    reader.error(DiagnosticId::limit_exceeded, reader.document.where(settings),
                 fmt::format("the graph has {} settings; at most {} are allowed", nodes.size(),
                             limits::settings));
    reader.unknown_settings = true;
    return;
  }
  for (NodeId node : nodes) {
    const std::string_view name = reader.document.key(node);
    SettingDeclaration declared;
    declared.name = name;
    declared.where = reader.document.where_key(node);
    bool ok = check_name(name, "the name of a setting", declared.where, reader.diagnostics);
    if (ok && is_reserved_word(name)) {
      ok = false;
      reader.error(DiagnosticId::bad_name, declared.where,
                   fmt::format("'{}' is reserved for \"when\" expressions", name));
    }
    const SettingId id{static_cast<uint32_t>(reader.graph.settings.size())};
    ok &= read_setting(reader, node, id, declared);
    reader.setting_names.emplace(name, id);
    reader.graph.settings.push_back(std::move(declared));
    reader.broken_settings.push_back(!ok);
  }
}

} // namespace dermis
