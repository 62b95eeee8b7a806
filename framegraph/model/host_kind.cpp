#include "framegraph/model/host_kind.hpp"

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace dermis {
namespace {

constexpr std::string_view own_prefix = "subsurface."; // names of the library's kinds begin with it

// What a host may do at a port: in the order of dermis_port_usage.
constexpr std::array host_usages{Usage::sampled_image,         Usage::storage_image_write,
                                 Usage::storage_image_update,  Usage::storage_buffer_read,
                                 Usage::storage_buffer_write,  Usage::storage_buffer_update,
                                 Usage::acceleration_structure};
constexpr std::array<std::string_view, 3> type_words{"bool", "int", "real"};
constexpr std::array types{SettingType::boolean, SettingType::integer, SettingType::real};
constexpr std::array<std::string_view, 2> scope_words{"graph", "frame"};

bool is_name(std::string_view text) {
  if (text.empty() || text.size() > limits::name_bytes) return false;
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [&](char c) { return letter(c) || digit(c); });
}

bool is_kind_name(std::string_view text) {
  const size_t dot = text.find('.');
  return dot != std::string_view::npos && is_name(text.substr(0, dot)) && is_name(text.substr(dot + 1));
}

KindProblem problem_of(const HostKindSetting& setting, size_t i) {
  if (!is_name(setting.name))
    return {
        DiagnosticId::bad_name,
        fmt::format("settings[{}].name is '{}', expected letters, digits and underscores", i, setting.name)};
  const auto range = [](std::string text) {
    return KindProblem{DiagnosticId::setting_range, std::move(text)};
  };
  if (setting.type == SettingType::boolean)
    return setting.default_value == 0.0 || setting.default_value == 1.0
               ? KindProblem{}
               : range(fmt::format("settings[{}].default_value is {}, a bool is 0 or 1", i,
                                   setting.default_value));
  const double most = limits::host_kind_value;
  if (!(setting.minimum >= -most && setting.maximum <= most && setting.minimum <= setting.default_value &&
        setting.default_value <= setting.maximum))
    return range(fmt::format("settings[{}]: expected {:g} <= minimum <= default_value <= maximum <= {:g}", i,
                             -most, most));
  const auto whole = [](double value) { return std::floor(value) == value; };
  const bool whole_range = whole(setting.minimum) && whole(setting.maximum) && whole(setting.default_value);
  if (setting.type == SettingType::integer && !whole_range)
    return range(fmt::format("settings[{}] is an int, but not all of its values are whole", i));
  return {};
}

template <class List> KindProblem duplicate_in(const List& list, std::string_view what) {
  for (size_t i = 0; i < list.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if (list[i].name == list[j].name)
        return {DiagnosticId::duplicate_name,
                fmt::format("{}[{}] and [{}] have the same name '{}'", what, j, i, list[i].name)};
  return {};
}

SettingValue value_of(SettingType type, double number) {
  SettingValue value;
  value.type = type;
  if (type == SettingType::real)
    value.real = number;
  else
    value.integer = static_cast<int64_t>(number);
  return value;
}

HostKindPort read_port(const Document& document, NodeId node, Diagnostics& diagnostics) {
  std::array<std::string_view, host_usages.size()> words;
  for (size_t i = 0; i < words.size(); ++i)
    words[i] = usage_info(host_usages[i]).name;
  ObjectReader object(document, node, "port", diagnostics);
  HostKindPort port;
  port.name = object.name("name").value_or("");
  port.usage = host_usages[object.word("usage", words).value_or(0)];
  port.optional = object.boolean("optional", Need::optional).value_or(false);
  port.own_texels = object.boolean("own_texels", Need::optional).value_or(false);
  port.doc = object.string("doc", Need::optional).value_or("");
  object.finish();
  return port;
}

HostKindSetting read_setting(const Document& document, NodeId node, Diagnostics& diagnostics) {
  ObjectReader object(document, node, "setting", diagnostics);
  HostKindSetting setting;
  setting.name = object.name("name").value_or("");
  setting.type = types[object.word("type", type_words).value_or(0)];
  const double most = limits::host_kind_value;
  setting.default_value = object.number("default", -most, most).value_or(0.0);
  const Need range = setting.type == SettingType::boolean ? Need::optional : Need::required;
  setting.minimum = object.number("min", -most, most, range).value_or(0.0);
  setting.maximum = object.number("max", -most, most, range).value_or(0.0);
  setting.unit = object.string("unit", Need::optional).value_or("");
  setting.per_frame = object.word("per", scope_words, Need::optional).value_or(0) == 1;
  setting.doc = object.string("doc", Need::optional).value_or("");
  object.finish();
  return setting;
}

HostKindDeclaration read_kind(const Document& document, NodeId node, Diagnostics& diagnostics) {
  const uint32_t errors = diagnostics.count(Severity::error);
  ObjectReader object(document, node, "kind", diagnostics);
  HostKindDeclaration kind;
  kind.name = object.string("name").value_or("");
  kind.doc = object.string("doc", Need::optional).value_or("");
  kind.side_effects = object.boolean("side_effects", Need::optional).value_or(false);
  kind.serves_scattering = object.boolean("serves_scattering", Need::optional).value_or(false);
  if (const NodeId ports = object.array("ports", 1, limits::host_kind_ports); ports.valid())
    for (const NodeId port : children(document, ports))
      kind.ports.push_back(read_port(document, port, diagnostics));
  if (const NodeId settings = object.array("settings", 0, limits::host_kind_settings, Need::optional);
      settings.valid())
    for (const NodeId setting : children(document, settings))
      kind.settings.push_back(read_setting(document, setting, diagnostics));
  object.finish();
  if (diagnostics.count(Severity::error) != errors) return kind;
  if (const KindProblem problem = problem_of(kind); !problem.text.empty())
    diagnostics.add(problem.id, document.where(node), problem.text);
  return kind;
}

} // namespace

KindProblem problem_of(const HostKindDeclaration& kind) {
  const auto name = [](std::string text) { return KindProblem{DiagnosticId::bad_name, std::move(text)}; };
  const auto count = [](std::string text) {
    return KindProblem{DiagnosticId::out_of_range, std::move(text)};
  };
  if (!is_kind_name(kind.name))
    return name(fmt::format(
        "name is '{}', expected two names with a dot between them, as in \"studio.bloom\"", kind.name));
  if (std::string_view(kind.name).substr(0, own_prefix.size()) == own_prefix)
    return name(
        fmt::format("name is '{}'; names that begin with '{}' are the library's", kind.name, own_prefix));
  if (kind.ports.empty() || kind.ports.size() > limits::host_kind_ports)
    return count(
        fmt::format("there are {} ports, expected 1..{}", kind.ports.size(), limits::host_kind_ports));
  if (kind.settings.size() > limits::host_kind_settings)
    return count(fmt::format("there are {} settings, expected 0..{}", kind.settings.size(),
                             limits::host_kind_settings));
  for (size_t i = 0; i < kind.ports.size(); ++i)
    if (!is_name(kind.ports[i].name))
      return name(fmt::format("ports[{}].name is '{}', expected letters, digits and underscores", i,
                              kind.ports[i].name));
  for (size_t i = 0; i < kind.settings.size(); ++i)
    if (KindProblem problem = problem_of(kind.settings[i], i); !problem.text.empty()) return problem;
  if (KindProblem problem = duplicate_in(kind.ports, "ports"); !problem.text.empty()) return problem;
  return duplicate_in(kind.settings, "settings");
}

KindId HostKinds::add(HostKindDeclaration kind, KindRegistry& registry) {
  if (registry.find(kind.name).valid()) return {};
  Kept& kept = kinds_.emplace_back();
  kept.declared = std::move(kind);
  for (const HostKindPort& port : kept.declared.ports) {
    Port& added = kept.ports.emplace_back();
    added.name = port.name;
    added.usage = port.usage;
    added.optional = port.optional;
    added.own_texels = port.own_texels;
    added.doc = port.doc;
  }
  for (const HostKindSetting& setting : kept.declared.settings) {
    KindSetting& added = kept.settings.emplace_back();
    added.name = setting.name;
    added.type = setting.type;
    added.default_value = value_of(setting.type, setting.default_value);
    added.minimum = setting.minimum;
    added.maximum = setting.maximum;
    added.unit = setting.unit;
    added.doc = setting.doc;
    added.per_frame = setting.per_frame;
  }
  PassKind made;
  made.name = kept.declared.name;
  made.doc = kept.declared.doc;
  made.ports = kept.ports;
  made.settings = kept.settings;
  made.dispatch = DispatchShape::host;
  made.side_effects = kept.declared.side_effects;
  made.serves_scattering = kept.declared.serves_scattering;
  return registry.add(made);
}

std::string write_host_kinds(const HostKinds& kinds) {
  JsonWriter json;
  json.open_object().member("dermis_kinds", 1).key("kinds").open_array();
  for (size_t k = 0; k < kinds.size(); ++k) {
    const HostKindDeclaration& kind = kinds[k];
    json.open_object().member("name", kind.name);
    if (!kind.doc.empty()) json.member("doc", kind.doc);
    if (kind.side_effects) json.member("side_effects", true);
    if (kind.serves_scattering) json.member("serves_scattering", true);
    json.key("ports").open_array();
    for (const HostKindPort& port : kind.ports) {
      json.open_object(true).member("name", port.name).member("usage", usage_info(port.usage).name);
      if (port.optional) json.member("optional", true);
      if (port.own_texels) json.member("own_texels", true);
      if (!port.doc.empty()) json.member("doc", port.doc);
      json.close();
    }
    json.close().key("settings").open_array();
    for (const HostKindSetting& setting : kind.settings) {
      const auto type =
          static_cast<size_t>(std::find(types.begin(), types.end(), setting.type) - types.begin());
      json.open_object(true).member("name", setting.name).member("type", type_words[type]);
      json.member("default", setting.default_value);
      if (setting.type != SettingType::boolean)
        json.member("min", setting.minimum).member("max", setting.maximum);
      if (!setting.unit.empty()) json.member("unit", setting.unit);
      if (setting.per_frame) json.member("per", scope_words[1]);
      if (!setting.doc.empty()) json.member("doc", setting.doc);
      json.close();
    }
    json.close().close();
  }
  json.close().close();
  return std::move(json).finish();
}

std::optional<std::vector<HostKindDeclaration>> read_host_kinds(const Document& document,
                                                                Diagnostics& diagnostics) {
  const uint32_t errors = diagnostics.count(Severity::error);
  if (!check_version(document, "dermis_kinds", 1, diagnostics)) return std::nullopt;
  ObjectReader root(document, document.root(), "file of kinds", diagnostics);
  root.any("dermis_kinds");
  std::vector<HostKindDeclaration> kinds;
  if (const NodeId list = root.array("kinds", 0, limits::host_kinds); list.valid())
    for (const NodeId node : children(document, list)) {
      kinds.push_back(read_kind(document, node, diagnostics));
      const auto same = [&](const HostKindDeclaration& other) { return other.name == kinds.back().name; };
      if (std::find_if(kinds.begin(), kinds.end() - 1, same) != kinds.end() - 1)
        diagnostics.add(DiagnosticId::duplicate_name, document.where(node),
                        fmt::format("there are two kinds '{}'", kinds.back().name));
    }
  root.finish();
  if (diagnostics.count(Severity::error) != errors) return std::nullopt;
  return kinds;
}

} // namespace dermis
