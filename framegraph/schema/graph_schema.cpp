#include "framegraph/schema/graph_schema.hpp"

#include "framegraph/schema/definitions.hpp"
#include "framegraph/text/json_writer.hpp"

#include <fmt/format.h>

namespace dermis {
namespace {

std::string with_unit(std::string_view doc, std::string_view unit) {
  return unit.empty() ? std::string(doc) : fmt::format("{} [{}]", doc, unit);
}

void write_setting(JsonWriter& out, const PassTypeSetting& setting) {
  out.key(setting.name).open_object(true);
  out.member("description", with_unit(setting.doc, setting.unit));
  out.key("anyOf").open_array().open_object();
  switch (setting.type) {
  case SettingType::boolean:
    out.member("type", "boolean");
    break;
  case SettingType::integer:
    out.member("type", "integer");
    out.member("minimum", static_cast<int64_t>(setting.minimum));
    out.member("maximum", static_cast<int64_t>(setting.maximum));
    break;
  case SettingType::real:
    out.member("type", "number")
        .member("minimum", setting.minimum)
        .member("maximum", setting.maximum);
    break;
  case SettingType::enumeration:
  case SettingType::choice:
    out.key("enum").open_array();
    for (const std::string_view option : setting.options)
      out.value(option);
    out.close();
    break;
  }
  out.close();
  out.open_object().member("type", "string");
  out.member("description", "\"$name\" follows the graph's setting of that name").close();
  out.close().close();
}

// Returns whether a port of this side must be bound.
bool write_ports(JsonWriter& out, const PassType& type, PortSide side) {
  std::vector<std::string_view> required;
  out.key(side == PortSide::read ? "read" : "write").open_object();
  out.member("type", "object").member("additionalProperties", false);
  out.key("properties").open_object();
  for (const Port& port : type.ports) {
    if (side_of(port) != side) continue;
    if (!port.optional) required.push_back(port.name);
    out.key(port.name).open_object(true);
    out.member("$ref", side == PortSide::read ? "#/definitions/source" : "#/definitions/target");
    out.member("description", fmt::format("{} ({})", port.doc, usage_info(port.usage).name))
        .close();
  }
  out.close();
  if (!required.empty()) {
    out.key("required").open_array(true);
    for (const std::string_view name : required)
      out.value(name);
    out.close();
  }
  bool one_of = false;
  for (uint32_t i = 0; i < type.ports.size(); ++i) {
    if (side_of(type.ports[i]) != side || !is_one_of(type, i)) continue;
    if (!one_of) out.key("anyOf").open_array(true);
    one_of = true;
    out.open_object(true)
        .key("required")
        .open_array(true)
        .value(type.ports[i].name)
        .close()
        .close();
  }
  if (one_of) out.close();
  out.close();
  return one_of || !required.empty();
}

void write_pass_type(JsonWriter& out, const PassType& type) {
  out.open_object();
  out.key("if").open_object(true).key("required").open_array().value("type").close();
  out.key("properties").open_object().key("type").open_object().member("const", type.name);
  out.close().close().close();
  out.key("then").open_object();
  out.member("description", type.doc);
  out.key("properties").open_object();
  const bool reads = write_ports(out, type, PortSide::read);
  const bool writes = write_ports(out, type, PortSide::write);
  out.key("set").open_object().member("type", "object").member("additionalProperties", false);
  out.key("properties").open_object();
  for (const PassTypeSetting& setting : type.settings)
    write_setting(out, setting);
  out.close().close().close();
  out.key("required").open_array(true);
  if (reads) out.value("read");
  if (writes) out.value("write");
  out.close().close().close();
}

std::string pass_type_names(const PassTypeRegistry& pass_types) {
  std::string out;
  for (uint32_t i = 0; i < pass_types.size(); ++i)
    out += fmt::format("{}\"{}\"", i == 0 ? "" : ", ", pass_types[{i}].name);
  return out;
}

std::string write_schema(const PassTypeRegistry& pass_types, std::string_view title,
                         std::string_view description, const SchemaMembers& root) {
  JsonWriter out;
  out.open_object();
  out.member("$schema", schema_dialect).member("title", title).member("description", description);
  for (const auto& [key, text] : root)
    out.key(key).json(text);
  out.key("definitions").open_object();
  for (const auto& [name, text] : graph_definitions(pass_type_names(pass_types)))
    out.key(name).json(text);
  out.key("pass_of_a_kind").open_object();
  out.key("allOf").open_array();
  for (uint32_t i = 0; i < pass_types.size(); ++i)
    write_pass_type(out, pass_types[{i}]);
  out.close().close().close().close();
  return std::move(out).finish();
}

} // namespace

std::string graph_schema(const PassTypeRegistry& pass_types) {
  return write_schema(
      pass_types, "Dermis graph",
      "A graph: settings, images and buffers, passes, and the images returned to the host. "
      "docs/format.md describes every key.",
      graph_root_members());
}

std::string fragment_schema(const PassTypeRegistry& pass_types) {
  return write_schema(
      pass_types, "Dermis fragment",
      "A part of a graph that several graphs can include. docs/overlays.md describes every key.",
      fragment_root_members());
}

} // namespace dermis
