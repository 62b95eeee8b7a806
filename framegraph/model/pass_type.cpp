#include "framegraph/model/pass_type.hpp"

#include <algorithm>

namespace dermis {
namespace {

template <class Named> int index_of(std::span<const Named> list, std::string_view name) {
  for (size_t i = 0; i < list.size(); ++i)
    if (list[i].name == name) return static_cast<int>(i);
  return -1;
}

} // namespace

bool works_with(const Port& port, Format format) {
  if (!port.formats.empty())
    return std::find(port.formats.begin(), port.formats.end(), format) != port.formats.end();
  if (usage_info(port.usage).writes && format_info(format).depth) return false;
  if (port.glsl_type.empty()) return true;
  return has_unsigned_components(format) == (port.glsl_type.front() == 'u');
}

bool is_constant(const PassTypeSetting& setting) {
  return !setting.per_frame && setting.type != SettingType::integer &&
         setting.type != SettingType::real;
}

bool may_order_internally(Usage usage) {
  return usage == Usage::storage_image_write || usage == Usage::storage_buffer_write;
}

PassTypeId PassTypeRegistry::add(const PassType& type) {
  if (find(type.name).valid()) return {};
  pass_types_.push_back(type);
  return PassTypeId{size() - 1};
}

PassTypeId PassTypeRegistry::find(std::string_view name) const {
  for (uint32_t i = 0; i < size(); ++i)
    if (pass_types_[i].name == name) return PassTypeId{i};
  return {};
}

int find_port(const PassType& type, std::string_view name) {
  return index_of(type.ports, name);
}

PortSide side_of(const Port& port) {
  return usage_info(port.usage).writes ? PortSide::write : PortSide::read;
}

int find_port(const PassType& type, std::string_view name, PortSide side) {
  for (size_t i = 0; i < type.ports.size(); ++i)
    if (type.ports[i].name == name && side_of(type.ports[i]) == side) return static_cast<int>(i);
  return -1;
}

int find_setting(const PassType& type, std::string_view name) {
  return index_of(type.settings, name);
}

uint32_t push_constant_bytes(const PassType& type) {
  const auto constants = std::ranges::count_if(type.settings, is_constant);
  return static_cast<uint32_t>(sizeof(uint32_t) *
                               (1 + type.settings.size() - static_cast<size_t>(constants)));
}

bool is_one_of(const PassType& type, uint32_t port) {
  return std::find(type.one_of.begin(), type.one_of.end(), type.ports[port].name) !=
         type.one_of.end();
}

} // namespace dermis
