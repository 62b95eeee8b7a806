// Reads "set" of a pass: literals and "$name"s for the settings of its pass type.

#include "framegraph/model/read/graph_reader.hpp"
#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis {

namespace {

std::string_view type_name(SettingType type) {
  switch (type) {
  case SettingType::boolean:
    return "a boolean";
  case SettingType::integer:
    return "an integer";
  case SettingType::real:
    return "a real number";
  case SettingType::enumeration:
    return "an enumeration";
  case SettingType::choice:
    return "a choice";
  }
  return "";
}

// Returns why the graph's setting cannot drive the pass type's setting; empty if it can.
std::string mismatch(const SettingDeclaration& from, const PassTypeSetting& to) {
  const SettingType type = from.type == SettingType::choice ? SettingType::enumeration : from.type;
  if (type != to.type)
    return fmt::format("it is {}, but the pass type's setting is {}", type_name(from.type),
                       type_name(to.type));
  if (type == SettingType::integer || type == SettingType::real) {
    if (from.minimum >= to.minimum && from.maximum <= to.maximum) return {};
    return fmt::format("its range {} .. {} exceeds the pass type's range {} .. {}", from.minimum,
                       from.maximum, to.minimum, to.maximum);
  }
  // Both hold the index of the option. A graph may omit the pass type's last options.
  const auto same = [](const std::string& a, std::string_view b) { return a == b; };
  if (type != SettingType::enumeration ||
      (from.options.size() <= to.options.size() &&
       std::equal(from.options.begin(), from.options.end(), to.options.begin(), same))) {
    return {};
  }
  return fmt::format(
      "its options must be the pass type's options {} in the same order, or the first of these",
      list_words(to.options));
}

bool read_reference(GraphReader& reader, NodeId node, const std::string& what,
                    const PassTypeSetting& setting, SettingBinding& out) {
  const std::string_view name = reader.document.text(node).substr(1);
  const SourceLocation where = reader.document.where(node);
  const auto found = reader.setting_names.find(name);
  if (found == reader.setting_names.end() && reader.unknown_settings) return false;
  if (found == reader.setting_names.end()) {
    reader
        .error(DiagnosticId::unknown_setting, where,
               fmt::format("{} follows '${}', but the graph has no such setting", what, name))
        .suggestion = did_you_mean(name, names_of(reader.setting_names));
    return false;
  }
  out.from = found->second;
  if (reader.broken_settings[out.from.value]) return false;
  const SettingDeclaration& declared = reader.graph.settings[out.from.value];
  const std::string why = mismatch(declared, setting);
  if (why.empty()) return true;
  reader
      .error(DiagnosticId::setting_mismatch, where,
             fmt::format("{} cannot follow '${}': {}", what, name, why))
      .related.emplace_back(declared.where, fmt::format("'{}' is declared here", name));
  return false;
}

bool read_text(GraphReader& reader, NodeId node, const std::string& what,
               const PassTypeSetting& setting, SettingValue& out) {
  const std::string_view text = reader.document.text(node);
  const auto found = std::find(setting.options.begin(), setting.options.end(), text);
  out.integer = found - setting.options.begin();
  if (found != setting.options.end()) return true;
  const std::string expected = setting.options.empty()
                                   ? fmt::format("{} or \"$name\"", type_name(setting.type))
                                   : list_words(setting.options);
  reader
      .error(DiagnosticId::setting_literal, reader.document.where(node),
             fmt::format("{} is '{}'; it must be {}", what, text, expected))
      .suggestion = did_you_mean(text, setting.options);
  return false;
}

bool read_literal(GraphReader& reader, NodeId node, const std::string& what,
                  const PassTypeSetting& setting, SettingValue& out) {
  out.type = setting.type;
  if (reader.document[node].kind == NodeKind::string)
    return read_text(reader, node, what, setting, out);
  switch (setting.type) {
  case SettingType::boolean:
    if (const auto value = read_boolean(reader.document, node, what, reader.diagnostics)) {
      out.integer = *value ? 1 : 0;
      return true;
    }
    return false;
  case SettingType::integer:
    if (const auto value =
            read_integer(reader.document, node, what, static_cast<int64_t>(setting.minimum),
                         static_cast<int64_t>(setting.maximum), reader.diagnostics)) {
      out.integer = *value;
      return true;
    }
    return false;
  case SettingType::real:
    if (const auto value = read_number(reader.document, node, what, setting.minimum,
                                       setting.maximum, reader.diagnostics)) {
      out.real = *value;
      return true;
    }
    return false;
  case SettingType::enumeration:
  case SettingType::choice:
    expect_kind(reader.document, node, what, NodeKind::string, reader.diagnostics);
    return false;
  }
  return false;
}

} // namespace

void read_pass_settings(GraphReader& reader, ObjectReader& pass, PassDeclaration& out) {
  const NodeId list = pass.object("set", Need::optional);
  if (!list.valid() || !out.type.valid()) return;
  const PassType& type = reader.pass_types[out.type];
  for (NodeId node : children(reader.document, list)) {
    const std::string_view name = reader.document.key(node);
    const int index = find_setting(type, name);
    if (index < 0) {
      std::vector<std::string_view> names;
      for (const PassTypeSetting& setting : type.settings)
        names.push_back(setting.name);
      reader
          .error(DiagnosticId::unknown_pass_setting, reader.document.where_key(node),
                 fmt::format("{} is of type '{}', which has {}", pass.what(), type.name,
                             names.empty() ? fmt::format("no settings; '{}' is unknown", name)
                                           : fmt::format("no setting '{}'; expected {}", name,
                                                         list_words(names))))
          .suggestion = did_you_mean(name, names);
      continue;
    }
    const PassTypeSetting& setting = type.settings[static_cast<size_t>(index)];
    const std::string what = fmt::format("setting '{}' of {}", name, pass.what());
    SettingBinding binding;
    binding.setting = static_cast<uint32_t>(index);
    binding.where = reader.document.where(node);
    const bool reference = reader.document[node].kind == NodeKind::string &&
                           reader.document.text(node).substr(0, 1) == "$";
    if (reference ? read_reference(reader, node, what, setting, binding)
                  : read_literal(reader, node, what, setting, binding.literal)) {
      out.settings.push_back(binding);
    }
  }
}

} // namespace dermis
