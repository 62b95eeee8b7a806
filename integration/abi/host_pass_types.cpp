#include "integration/abi/host_pass_types.hpp"

#include "integration/abi/context.hpp"
#include "integration/abi/two_call.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace dermis::abi {
namespace {

constexpr const char* registering = "dermis_register_pass_type";

std::string text_of(const char* text) {
  return text == nullptr ? "" : text;
}

constexpr std::array usages{Usage::sampled_image,         Usage::storage_image_write,
                            Usage::storage_image_update,  Usage::storage_buffer_read,
                            Usage::storage_buffer_write,  Usage::storage_buffer_update,
                            Usage::acceleration_structure};
constexpr std::array setting_types{SettingType::boolean, SettingType::integer, SettingType::real};

dermis_result read_ports(const Log& log, const dermis_pass_type& given,
                         HostPassTypeDeclaration& type) {
  if (given.port_count > 0 && given.ports == nullptr)
    return bad_argument(log, "{}: type.ports is NULL, port_count is {}", registering,
                        given.port_count);
  for (uint32_t i = 0; i < given.port_count; ++i) {
    dermis_port port = DERMIS_PORT_INIT;
    if (const SizedRead read = read_element(given.ports, i, port); read != SizedRead::ok)
      return rejected_element(log, read, registering, "type.ports", given.ports, i);
    const auto usage = static_cast<size_t>(port.usage);
    if (usage >= usages.size())
      return bad_argument(log, "{}: type.ports[{}].usage is {}, expected 0..{}", registering, i,
                          static_cast<int>(port.usage), usages.size() - 1);
    type.ports.push_back({text_of(port.name), text_of(port.doc), usages[usage], port.optional != 0,
                          port.own_texels != 0, port.internally_ordered != 0});
  }
  return DERMIS_OK;
}

dermis_result read_settings(const Log& log, const dermis_pass_type& given,
                            HostPassTypeDeclaration& type) {
  if (given.setting_count > 0 && given.settings == nullptr)
    return bad_argument(log, "{}: type.settings is NULL, setting_count is {}", registering,
                        given.setting_count);
  for (uint32_t i = 0; i < given.setting_count; ++i) {
    dermis_pass_setting setting = DERMIS_PASS_SETTING_INIT;
    if (const SizedRead read = read_element(given.settings, i, setting); read != SizedRead::ok)
      return rejected_element(log, read, registering, "type.settings", given.settings, i);
    const auto value_type = static_cast<size_t>(setting.type);
    if (value_type >= setting_types.size())
      return bad_argument(log, "{}: type.settings[{}].type is {}, expected 0..{}", registering, i,
                          static_cast<int>(setting.type), setting_types.size() - 1);
    type.settings.push_back({text_of(setting.name), text_of(setting.unit), text_of(setting.doc),
                             setting_types[value_type], setting.default_value, setting.minimum,
                             setting.maximum, setting.per_frame != 0});
  }
  return DERMIS_OK;
}

dermis_result add(dermis_context_t& context, const dermis_pass_type* given) {
  const Log& log = context.log;
  dermis_pass_type desc = DERMIS_PASS_TYPE_INIT;
  if (const SizedRead read = read_sized(given, desc); read != SizedRead::ok)
    return rejected_size(log, read, "dermis_register_pass_type: type", stated_size(given),
                         sizeof(dermis_pass_type));
  if (desc.record == nullptr) return bad_argument(log, "{}: type.record is NULL", registering);
  if (desc.port_count > limits::host_pass_type_ports ||
      desc.setting_count > limits::host_pass_type_settings)
    return bad_argument(
        log, "{}: type.port_count is {} and setting_count {}, at most {} and {} are possible",
        registering, desc.port_count, desc.setting_count, limits::host_pass_type_ports,
        limits::host_pass_type_settings);
  HostPassTypeDeclaration type;
  type.name = text_of(desc.name);
  type.doc = text_of(desc.doc);
  type.side_effects = desc.side_effects != 0;
  type.serves_scattering = desc.serves_scattering != 0;
  if (const dermis_result result = read_ports(log, desc, type); result != DERMIS_OK) return result;
  if (const dermis_result result = read_settings(log, desc, type); result != DERMIS_OK)
    return result;
  return add_host_pass_type(context, std::move(type), desc.record, desc.user);
}

dermis_pass_port port_of(const vulkan::HostPort& port) {
  dermis_pass_port out = DERMIS_PASS_PORT_INIT;
  out.image = port.image;
  out.view = port.view;
  out.format = port.format;
  out.layout = port.layout;
  out.width = port.width;
  out.height = port.height;
  out.buffer = port.buffer;
  out.bytes = port.bytes;
  out.offset = port.offset;
  out.structure = port.structure;
  return out;
}

} // namespace

double number_of(const SettingValue& value) {
  return value.type == SettingType::real ? value.real : static_cast<double>(value.integer);
}

dermis_result add_host_pass_type(dermis_context_t& context, HostPassTypeDeclaration type,
                                 dermis_pass_fn record, void* user) {
  const Log& log = context.log;
  if (const PassTypeProblem problem = problem_of(type); !problem.text.empty())
    return bad_argument(log, "{}: type.{}", registering, problem.text);

  const std::lock_guard lock(context.mutex);
  if (!context.graphs.empty())
    return bad_argument(log, "{}: the context has graphs already; register '{}' before the first",
                        registering, type.name);
  HostPasses& passes = context.host_passes;
  if (passes.pass_types.size() == limits::host_pass_types)
    return bad_argument(log, "{}: the context has {} pass types already", registering,
                        limits::host_pass_types);
  if (context.pass_types.find(type.name).valid())
    return bad_argument(log, "{}: there is a pass type '{}' already", registering, type.name);
  // reserved first, so that nothing fails once the pass type is registered
  passes.recorders.reserve(passes.recorders.size() + 1);
  const PassTypeId id = passes.pass_types.add(std::move(type), context.pass_types);
  passes.recorders.push_back({id, record, user});
  return DERMIS_OK;
}

void fill_host_pass(const vulkan::HostPass& call, HostPassCall& out) {
  std::transform(call.ports.begin(), call.ports.end(), out.ports.begin(), port_of);
  std::transform(call.settings.begin(), call.settings.end(), out.settings.begin(), number_of);
  out.call = DERMIS_PASS_CALL_INIT;
  out.call.pass = call.pass;
  out.call.command_buffer = call.command_buffer;
  out.call.ports = out.ports.data();
  out.call.settings = out.settings.data();
  out.call.port_count = static_cast<uint32_t>(call.ports.size());
  out.call.setting_count = static_cast<uint32_t>(call.settings.size());
  out.call.rect_x = call.rectangle.x;
  out.call.rect_y = call.rectangle.y;
  out.call.rect_width = call.rectangle.width;
  out.call.rect_height = call.rectangle.height;
  out.call.frame_index = call.frame_index;
  out.call.view_user = call.view_user;
}

void record_host_pass(void* host_passes, const vulkan::HostPass& call) {
  const auto& passes = *static_cast<const HostPasses*>(host_passes);
  const auto found =
      std::find_if(passes.recorders.begin(), passes.recorders.end(),
                   [&](const HostPasses::Recorder& one) { return one.type == call.type; });
  HostPassCall whole;
  fill_host_pass(call, whole);
  found->record(found->user, &whole.call);
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_register_pass_type(dermis_context context,
                                                               const dermis_pass_type* type) {
  if (context == nullptr) return bad_argument({}, "dermis_register_pass_type: context is NULL");
  return guarded(context->log, registering, [&] {
    if (type == nullptr)
      return bad_argument(context->log, "dermis_register_pass_type: type is NULL");
    return add(*context, type);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_export_pass_types(dermis_context context, size_t* size,
                                                              char* text) {
  if (context == nullptr) return bad_argument({}, "dermis_export_pass_types: context is NULL");
  return guarded(context->log, "dermis_export_pass_types", [&] {
    if (size == nullptr)
      return bad_argument(context->log, "dermis_export_pass_types: size is NULL");
    return fill_text(dermis::write_host_pass_types(context->host_passes.pass_types), size, text);
  });
}
