#include "framegraph/text/document.hpp"
#include "integration/abi/compiled_graph.hpp"

#include <fmt/format.h>

#include <cmath>

namespace dermis::abi {
namespace {

const char* type_name(SettingType type) {
  switch (type) {
  case SettingType::boolean:
    return "true or false";
  case SettingType::integer:
    return "an integer";
  case SettingType::real:
    return "a number";
  case SettingType::enumeration:
  case SettingType::choice:
    break;
  }
  return "a string";
}

std::string option_list(const SettingDeclaration& declared) {
  std::string list;
  for (const std::string& option : declared.options)
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", option);
  return list;
}

bool in_range(const SettingDeclaration& declared, double value) {
  return std::isfinite(value) && value >= declared.minimum && value <= declared.maximum;
}

} // namespace

std::optional<SettingValue> read_setting(const SettingDeclaration& declared,
                                         const std::string& json, Diagnostics& diagnostics) {
  const auto document = parse_document(fmt::format("setting {}", declared.name), json, diagnostics);
  if (!document) return std::nullopt;
  const Node& node = (*document)[document->root()];
  SettingValue value{declared.type, 0, 0.0};
  const auto reject = [&](DiagnosticId id,
                          const std::string& expected) -> std::optional<SettingValue> {
    diagnostics.add(
        id, document->where(document->root()),
        fmt::format("setting '{}' expects {}, found {}", declared.name, expected, json));
    return std::nullopt;
  };
  const std::string range =
      fmt::format("{} in {}..{}", type_name(declared.type), declared.minimum, declared.maximum);
  switch (declared.type) {
  case SettingType::boolean:
    if (node.kind != NodeKind::boolean) break;
    value.integer = node.integer;
    return value;
  case SettingType::integer:
    if (node.kind != NodeKind::integer) break;
    if (!in_range(declared, static_cast<double>(node.integer)))
      return reject(DiagnosticId::out_of_range, range);
    value.integer = node.integer;
    return value;
  case SettingType::real:
    if (node.kind != NodeKind::integer && node.kind != NodeKind::real) break;
    if (!in_range(declared, node.real)) return reject(DiagnosticId::out_of_range, range);
    value.real = node.real;
    return value;
  case SettingType::enumeration:
  case SettingType::choice:
    if (node.kind != NodeKind::string) break;
    for (size_t i = 0; i < declared.options.size(); ++i)
      if (declared.options[i] == document->text(document->root())) {
        value.integer = static_cast<int64_t>(i);
        return value;
      }
    return reject(DiagnosticId::invalid_value, "one of " + option_list(declared));
  }
  return reject(DiagnosticId::wrong_type, type_name(declared.type));
}

} // namespace dermis::abi
