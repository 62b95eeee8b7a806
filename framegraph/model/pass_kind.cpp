#include "framegraph/model/pass_kind.hpp"

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

KindId KindRegistry::add(const PassKind& kind) {
  if (find(kind.name).valid()) return {};
  kinds_.push_back(kind);
  return KindId{size() - 1};
}

KindId KindRegistry::find(std::string_view name) const {
  for (uint32_t i = 0; i < size(); ++i)
    if (kinds_[i].name == name) return KindId{i};
  return {};
}

int find_port(const PassKind& kind, std::string_view name) {
  return index_of(kind.ports, name);
}

PortSide side_of(const Port& port) {
  return usage_info(port.usage).writes ? PortSide::write : PortSide::read;
}

int find_port(const PassKind& kind, std::string_view name, PortSide side) {
  for (size_t i = 0; i < kind.ports.size(); ++i)
    if (kind.ports[i].name == name && side_of(kind.ports[i]) == side) return static_cast<int>(i);
  return -1;
}

int find_setting(const PassKind& kind, std::string_view name) {
  return index_of(kind.settings, name);
}

bool is_one_of(const PassKind& kind, uint32_t port) {
  return std::find(kind.one_of.begin(), kind.one_of.end(), kind.ports[port].name) != kind.one_of.end();
}

} // namespace dermis
