#include "framegraph/model/host_pass_type.hpp"

#include "framegraph/text/json_writer.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/reader.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace dermis {
namespace {

constexpr std::string_view own_prefix = "subsurface."; // prefix of the library's pass types

// Usages that a host may declare, in the order of dermis_port_usage.
constexpr std::array host_usages{Usage::sampled_image,         Usage::storage_image_write,
                                 Usage::storage_image_update,  Usage::storage_buffer_read,
                                 Usage::storage_buffer_write,  Usage::storage_buffer_update,
                                 Usage::acceleration_structure};
constexpr std::array<std::string_view, 3> type_words{"bool", "int", "real"};
constexpr std::array types{SettingType::boolean, SettingType::integer, SettingType::real};
constexpr std::array<std::string_view, 2> scope_words{"graph", "frame"};

bool is_name(std::string_view text) {
  if (text.empty() || text.size() > limits::name_bytes) return false;
  const auto letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
  };
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [&](char c) { return letter(c) || digit(c); });
}

bool is_pass_type_name(std::string_view text) {
  const size_t dot = text.find('.');
  return dot != std::string_view::npos && is_name(text.substr(0, dot)) &&
         is_name(text.substr(dot + 1));
}

PassTypeProblem problem_of(const HostPassTypeSetting& setting, size_t i) {
  if (!is_name(setting.name))
    return {DiagnosticId::bad_name,
            fmt::format("settings[{}].name is '{}', expected letters, digits and underscores", i,
                        setting.name)};
  const auto range = [](std::string text) {
    return PassTypeProblem{DiagnosticId::setting_range, std::move(text)};
  };
  if (setting.type == SettingType::boolean)
    return setting.default_value == 0.0 || setting.default_value == 1.0
               ? PassTypeProblem{}
               : range(fmt::format("settings[{}].default_value is {}; expected 0 or 1 for a bool",
                                   i, setting.default_value));
  const double maximum = limits::host_pass_type_value;
  if (!(setting.minimum >= -maximum && setting.maximum <= maximum &&
        setting.minimum <= setting.default_value && setting.default_value <= setting.maximum))
    return range(
        fmt::format("settings[{}]: expected {:g} <= minimum <= default_value <= maximum <= {:g}", i,
                    -maximum, maximum));
  const auto whole = [](double value) { return std::floor(value) == value; };
  const bool whole_range =
      whole(setting.minimum) && whole(setting.maximum) && whole(setting.default_value);
  if (setting.type == SettingType::integer && !whole_range)
    return range(fmt::format(
        "settings[{}] is an int; its minimum, default_value and maximum must be integers", i));
  return {};
}

template <class List> PassTypeProblem duplicate_in(const List& list, std::string_view what) {
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

HostPassTypePort read_port(const Document& document, NodeId node, Diagnostics& diagnostics) {
  std::array<std::string_view, host_usages.size()> words;
  for (size_t i = 0; i < words.size(); ++i)
    words[i] = usage_info(host_usages[i]).name;
  ObjectReader object(document, node, "port", diagnostics);
  HostPassTypePort port;
  port.name = object.name("name").value_or("");
  port.usage = host_usages[object.word("usage", words).value_or(0)];
  port.optional = object.boolean("optional", Need::optional).value_or(false);
  port.own_texels = object.boolean("own_texels", Need::optional).value_or(false);
  port.internally_ordered = object.boolean("internally_ordered", Need::optional).value_or(false);
  port.doc = object.string("doc", Need::optional).value_or("");
  object.finish();
  return port;
}

HostPassTypeSetting read_setting(const Document& document, NodeId node, Diagnostics& diagnostics) {
  ObjectReader object(document, node, "setting", diagnostics);
  HostPassTypeSetting setting;
  setting.name = object.name("name").value_or("");
  setting.type = types[object.word("type", type_words).value_or(0)];
  const double maximum = limits::host_pass_type_value;
  setting.default_value = object.number("default", -maximum, maximum).value_or(0.0);
  const Need range = setting.type == SettingType::boolean ? Need::optional : Need::required;
  setting.minimum = object.number("min", -maximum, maximum, range).value_or(0.0);
  setting.maximum = object.number("max", -maximum, maximum, range).value_or(0.0);
  setting.unit = object.string("unit", Need::optional).value_or("");
  setting.per_frame = object.word("per", scope_words, Need::optional).value_or(0) == 1;
  setting.doc = object.string("doc", Need::optional).value_or("");
  object.finish();
  return setting;
}

HostPassTypeDeclaration read_pass_type(const Document& document, NodeId node,
                                       Diagnostics& diagnostics) {
  const uint64_t errors = diagnostics.errors();
  ObjectReader object(document, node, "pass type", diagnostics);
  HostPassTypeDeclaration type;
  type.name = object.string("name").value_or("");
  type.doc = object.string("doc", Need::optional).value_or("");
  type.side_effects = object.boolean("side_effects", Need::optional).value_or(false);
  type.serves_scattering = object.boolean("serves_scattering", Need::optional).value_or(false);
  if (const NodeId ports = object.array("ports", 1, limits::host_pass_type_ports); ports.valid())
    for (const NodeId port : children(document, ports))
      type.ports.push_back(read_port(document, port, diagnostics));
  if (const NodeId settings =
          object.array("settings", 0, limits::host_pass_type_settings, Need::optional);
      settings.valid())
    for (const NodeId setting : children(document, settings))
      type.settings.push_back(read_setting(document, setting, diagnostics));
  object.finish();
  if (diagnostics.errors() != errors) return type;
  if (const PassTypeProblem problem = problem_of(type); !problem.text.empty())
    diagnostics.add(problem.id, document.where(node), problem.text);
  return type;
}

} // namespace

PassTypeProblem problem_of(const HostPassTypeDeclaration& type) {
  const auto name = [](std::string text) {
    return PassTypeProblem{DiagnosticId::bad_name, std::move(text)};
  };
  const auto count = [](std::string text) {
    return PassTypeProblem{DiagnosticId::out_of_range, std::move(text)};
  };
  if (!is_pass_type_name(type.name))
    return name(fmt::format(
        "name is '{}'; expected two names separated by a dot, as in \"studio.bloom\"", type.name));
  if (std::string_view(type.name).substr(0, own_prefix.size()) == own_prefix)
    return name(fmt::format("name is '{}'; names that begin with '{}' are reserved for the library",
                            type.name, own_prefix));
  if (type.ports.empty() || type.ports.size() > limits::host_pass_type_ports)
    return count(fmt::format("ports has {} entries, expected 1..{}", type.ports.size(),
                             limits::host_pass_type_ports));
  if (type.settings.size() > limits::host_pass_type_settings)
    return count(fmt::format("settings has {} entries, expected 0..{}", type.settings.size(),
                             limits::host_pass_type_settings));
  for (size_t i = 0; i < type.ports.size(); ++i)
    if (!is_name(type.ports[i].name))
      return name(fmt::format("ports[{}].name is '{}', expected letters, digits and underscores", i,
                              type.ports[i].name));
  for (size_t i = 0; i < type.ports.size(); ++i)
    if (type.ports[i].internally_ordered && !may_order_internally(type.ports[i].usage))
      return {DiagnosticId::bad_internal_order,
              fmt::format("ports[{}] ('{}') declares internally_ordered and has usage {}, expected "
                          "storage_image_write or storage_buffer_write",
                          i, type.ports[i].name, usage_info(type.ports[i].usage).name)};
  for (size_t i = 0; i < type.settings.size(); ++i)
    if (PassTypeProblem problem = problem_of(type.settings[i], i); !problem.text.empty())
      return problem;
  if (PassTypeProblem problem = duplicate_in(type.ports, "ports"); !problem.text.empty())
    return problem;
  return duplicate_in(type.settings, "settings");
}

// The name and texts of the registered type point into `kept`.
PassTypeId HostPassTypes::add_kept(Kept& kept, PassTypeRegistry& registry) {
  for (const HostPassTypePort& port : kept.declared.ports) {
    Port& added = kept.ports.emplace_back();
    added.name = port.name;
    added.usage = port.usage;
    added.optional = port.optional;
    added.own_texels = port.own_texels;
    added.internally_ordered = port.internally_ordered;
    added.doc = port.doc;
  }
  for (const HostPassTypeSetting& setting : kept.declared.settings) {
    PassTypeSetting& added = kept.settings.emplace_back();
    added.name = setting.name;
    added.type = setting.type;
    added.default_value = value_of(setting.type, setting.default_value);
    added.minimum = setting.minimum;
    added.maximum = setting.maximum;
    added.unit = setting.unit;
    added.doc = setting.doc;
    added.per_frame = setting.per_frame;
  }
  PassType made;
  made.name = kept.declared.name;
  made.doc = kept.declared.doc;
  made.ports = kept.ports;
  made.settings = kept.settings;
  made.dispatch = {.name = "host", .domain = DispatchRule::Domain::host};
  made.side_effects = kept.declared.side_effects;
  made.serves_scattering = kept.declared.serves_scattering;
  return registry.add(made);
}

PassTypeId HostPassTypes::add(HostPassTypeDeclaration type, PassTypeRegistry& registry) {
  if (registry.find(type.name).valid()) return {};
  Kept& kept = pass_types_.emplace_back();
  try {
    kept.declared = std::move(type);
    return add_kept(kept, registry);
  } catch (...) { // out of memory: nothing is registered
    pass_types_.pop_back();
    throw;
  }
}

std::string write_host_pass_types(const HostPassTypes& pass_types) {
  JsonWriter json;
  json.open_object().member("dermis_pass_types", 2).key("pass_types").open_array();
  for (size_t k = 0; k < pass_types.size(); ++k) {
    const HostPassTypeDeclaration& type = pass_types[k];
    json.open_object().member("name", type.name);
    if (!type.doc.empty()) json.member("doc", type.doc);
    if (type.side_effects) json.member("side_effects", true);
    if (type.serves_scattering) json.member("serves_scattering", true);
    json.key("ports").open_array();
    for (const HostPassTypePort& port : type.ports) {
      json.open_object(true).member("name", port.name).member("usage", usage_info(port.usage).name);
      if (port.optional) json.member("optional", true);
      if (port.own_texels) json.member("own_texels", true);
      if (port.internally_ordered) json.member("internally_ordered", true);
      if (!port.doc.empty()) json.member("doc", port.doc);
      json.close();
    }
    json.close().key("settings").open_array();
    for (const HostPassTypeSetting& setting : type.settings) {
      const auto word =
          static_cast<size_t>(std::find(types.begin(), types.end(), setting.type) - types.begin());
      json.open_object(true).member("name", setting.name).member("type", type_words[word]);
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

std::optional<std::vector<HostPassTypeDeclaration>> read_host_pass_types(const Document& document,
                                                                         Diagnostics& diagnostics) {
  const uint64_t errors = diagnostics.errors();
  if (!check_version(document, "dermis_pass_types", 2, diagnostics)) return std::nullopt;
  ObjectReader root(document, document.root(), "file of pass types", diagnostics);
  root.any("dermis_pass_types");
  std::vector<HostPassTypeDeclaration> pass_types;
  if (const NodeId list = root.array("pass_types", 0, limits::host_pass_types); list.valid())
    for (const NodeId node : children(document, list)) {
      pass_types.push_back(read_pass_type(document, node, diagnostics));
      const auto same = [&](const HostPassTypeDeclaration& other) {
        return other.name == pass_types.back().name;
      };
      if (std::find_if(pass_types.begin(), pass_types.end() - 1, same) != pass_types.end() - 1)
        diagnostics.add(
            DiagnosticId::duplicate_name, document.where(node),
            fmt::format("the pass type '{}' is declared twice", pass_types.back().name));
    }
  root.finish();
  if (diagnostics.errors() != errors) return std::nullopt;
  return pass_types;
}

} // namespace dermis
