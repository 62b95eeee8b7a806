// Tables of ports and settings of the pass types, from their signatures.
#include "framegraph/model/vocabulary.hpp"
#include "integration/tools/command/inspect/reference_pages/pages.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

std::string dispatch_text(const DispatchRule& rule) {
  const std::string cell = fmt::format("{0}x{0}", rule.cell_side);
  const std::string border =
      rule.border > 0 ? fmt::format(", which is extended by {} pixels", rule.border) : "";
  const std::string limit = rule.max_groups > 0 ? fmt::format(", at most {}", rule.max_groups) : "";
  switch (rule.domain) {
  case DispatchRule::Domain::rectangle:
    return rule.cells_per_group == 1
               ? fmt::format("one group per {} pixels of the render rectangle{}", cell, border)
               : fmt::format("one group per {} squares of {} pixels of the render rectangle{}{}",
                             rule.cells_per_group, cell, border, limit);
  case DispatchRule::Domain::written_image:
    return fmt::format("one group per {} texels of the first image that it writes", cell);
  case DispatchRule::Domain::indirect:
    return "by indirect arguments";
  case DispatchRule::Domain::one:
    return "one group";
  case DispatchRule::Domain::none:
    return "no dispatch";
  case DispatchRule::Domain::host:
    break;
  }
  return "recorded by the host";
}

std::string value_text(const PassTypeSetting& setting, const SettingValue& value) {
  switch (setting.type) {
  case SettingType::boolean:
    return value.integer != 0 ? "true" : "false";
  case SettingType::real:
    return fmt::format("{}", value.real);
  case SettingType::integer:
    return fmt::format("{}", value.integer);
  case SettingType::enumeration:
  case SettingType::choice:
    break;
  }
  return fmt::format("`{}`", setting.options[static_cast<size_t>(value.integer)]);
}

std::string range_text(const PassTypeSetting& setting) {
  if (setting.type == SettingType::boolean) return "true, false";
  std::string text;
  for (const std::string_view option : setting.options)
    text += fmt::format("{}`{}`", text.empty() ? "" : ", ", option);
  return setting.options.empty() ? fmt::format("{} .. {}", setting.minimum, setting.maximum) : text;
}

// Returns "; at least ..." for a port, or "" if any size is valid.
std::string need_text(const PassType& type, const Port& port) {
  for (const PortNeed& need : type.needs) {
    if (need.port != port.name) continue;
    const std::string square =
        need.square == 1 ? "pixel" : fmt::format("{0}x{0} pixels", need.square);
    if (need.bytes == 0 && need.more == 0) return fmt::format("; one texel per {}", square);
    if (need.square == 0) return fmt::format("; {} bytes", need.more);
    return fmt::format("; {} bytes per {}{}", need.bytes, square,
                       need.more > 0 ? fmt::format(" plus {}", need.more) : "");
  }
  return "";
}

} // namespace

std::string pass_types_page(const PassTypeRegistry& pass_types) {
  std::string out =
      "# Pass types\n\nPorts: `read` or `write`, then the usage, which decides "
      "stages, accesses and layouts, "
      "then the smallest size (D0229).\n*Own texels*: each invocation reads only "
      "what it writes, so that the "
      "pass may write the same resource.\n*Internally ordered*: the kernel also reads "
      "what its dispatch wrote through the port, and orders these accesses.\n*Per frame*: the "
      "setting may differ "
      "between views of a graph.\n";
  for (uint32_t k = 0; k < pass_types.size(); ++k) {
    const PassType& type = pass_types[PassTypeId{k}];
    out += fmt::format("\n## {}\n\n{} Runs {}{}.\n", type.name, type.doc,
                       dispatch_text(type.dispatch), type.side_effects ? "; never culled" : "");
    for (const std::string_view port : type.one_of)
      out += fmt::format(
          "{}`{}`",
          port == type.one_of.front() ? "\nAt least one of these ports must be bound: " : ", ",
          port);
    if (!type.one_of.empty()) out += ".\n";
    out += "\n| port | | | |\n|---|---|---|---|\n";
    for (const Port& port : type.ports) {
      std::string formats;
      for (const Format format : port.formats)
        formats += fmt::format("{}{}", formats.empty() ? "; " : ", ", format_info(format).name);
      out +=
          fmt::format("| `{}` | {}{}{}{} | {}{}{} | {} |\n", port.name,
                      side_of(port) == PortSide::read ? "read" : "write",
                      port.optional ? ", optional" : "", port.own_texels ? ", own texels" : "",
                      port.internally_ordered ? ", internally ordered" : "",
                      usage_info(port.usage).name, formats, need_text(type, port), cell(port.doc));
    }
    if (type.settings.empty()) continue;
    out += "\n| setting | default | | |\n|---|---|---|---|\n";
    for (const PassTypeSetting& setting : type.settings)
      out += fmt::format("| `{}` | {} | {}{}{} | {} |\n", setting.name,
                         value_text(setting, setting.default_value), range_text(setting),
                         setting.unit.empty() ? "" : fmt::format(" {}", setting.unit),
                         setting.per_frame ? "; per frame" : "", cell(setting.doc));
  }
  return out;
}

} // namespace dermis::tools
