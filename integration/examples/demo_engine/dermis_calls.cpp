#include "integration/examples/demo_engine/dermis_calls.hpp"

#include <fmt/format.h>

namespace demo {
namespace {

ErrorKind kind_of(dermis_result result) {
  switch (result) {
  case DERMIS_ERROR_CONFIG:
  case DERMIS_ERROR_SHADER:
    return ErrorKind::input;
  case DERMIS_ERROR_UNSUPPORTED:
  case DERMIS_ERROR_MEMORY:
  case DERMIS_ERROR_DEVICE_MEMORY:
  case DERMIS_ERROR_VULKAN:
  case DERMIS_ERROR_DEVICE_LOST:
    return ErrorKind::environment;
  default:
    return ErrorKind::internal;
  }
}

} // namespace

Error dermis_error(const char* call, dermis_result result, dermis_report report) {
  if (dermis_report_count(report) > 0)
    return {kind_of(result), dermis_report_text(report), dermis_report_json(report)};
  const char* detail = dermis_last_error();
  return {kind_of(result), fmt::format("{}: {}{}{}", call, dermis_result_name(result),
                                       detail ? ": " : "", detail ? detail : "")};
}

dermis_source source_of(const std::string& name, const std::string& text) {
  dermis_source source = DERMIS_SOURCE_INIT;
  source.name = name.c_str();
  // An empty file as a space, so that the library says what is missing, and where.
  source.text = text.empty() ? " " : text.data();
  source.length = text.empty() ? 1 : text.size();
  return source;
}

uint32_t DERMIS_CALL deliver(void* user, const char* name, dermis_source* source) {
  auto& delivery = *static_cast<Delivery*>(user);
  std::optional<NamedText> file = delivery.open(name);
  if (!file) return 0;
  const NamedText& kept = delivery.delivered.emplace_back(std::move(*file));
  *source = source_of(kept.name, kept.text);
  return 1;
}

Result<dermis_graph> create_graph(dermis_context context, const GraphRequest& request,
                                  Report& report) {
  std::vector<dermis_profile> profiles;
  for (const GraphRequest::Profile& one : request.profiles) {
    dermis_profile profile = DERMIS_PROFILE_INIT;
    profile.id = one.id;
    profile.source = source_of(one.name, one.text);
    profiles.push_back(profile);
  }
  std::vector<dermis_slot_format> formats;
  for (const auto& [name, vk_format] : request.formats) {
    dermis_slot_format format = DERMIS_SLOT_FORMAT_INIT;
    format.name = name.c_str();
    format.format = vk_format;
    formats.push_back(format);
  }
  std::vector<const char*> unbound;
  for (const std::string& name : request.unbound)
    unbound.push_back(name.c_str());
  std::vector<dermis_source> overlays;
  for (const NamedText& overlay : request.overlays)
    overlays.push_back(source_of(overlay.name, overlay.text));
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.source = source_of(request.graph_name, request.graph_text);
  desc.width = request.width;
  desc.height = request.height;
  desc.pixel_aspect = static_cast<float>(request.pixel_aspect);
  desc.profiles = profiles.data();
  desc.profile_count = static_cast<uint32_t>(profiles.size());
  desc.unbound = unbound.data();
  desc.unbound_count = static_cast<uint32_t>(unbound.size());
  desc.formats = formats.data();
  desc.format_count = static_cast<uint32_t>(formats.size());
  desc.overlays = overlays.data();
  desc.overlay_count = static_cast<uint32_t>(overlays.size());
  Delivery includes{request.include};
  if (request.include) desc.include = deliver;
  desc.include_user = &includes; // local, because no caller reloads a graph that includes files
  dermis_graph graph = nullptr;
  const dermis_result result = dermis_graph_create(context, &desc, &graph, &report.handle);
  if (result != DERMIS_OK) return dermis_error("dermis_graph_create", result, report.handle);
  return graph;
}

Result<> make_context(const VulkanHost& host, uint32_t frames_in_flight, bool enable_rays,
                      std::shared_ptr<dermis_context_t>& context, const ContextHooks& hooks) {
  if (context != nullptr) return success();
  dermis_context_desc desc = DERMIS_CONTEXT_DESC_INIT;
  if (host.timestamp_mask != 0) desc.flags |= DERMIS_CONTEXT_TIMINGS;
  if (host.ray_query && enable_rays) desc.flags |= DERMIS_CONTEXT_RAY_QUERY;
  if (host.kernels == KernelShape::gpu || host.kernels == KernelShape::gpu_small)
    desc.flags |= DERMIS_CONTEXT_GPU_KERNELS;
  if (host.kernels == KernelShape::gpu_small) desc.flags |= DERMIS_CONTEXT_SMALL_GROUPS;
  if (host.kernels == KernelShape::cpu) desc.flags |= DERMIS_CONTEXT_CPU_KERNELS;
  desc.frames_in_flight = frames_in_flight;
  desc.queue_family = host.queue_family;
  desc.instance = host.instance;
  desc.physical_device = host.physical_device;
  desc.device = host.device;
  desc.get_instance_proc_addr = vkGetInstanceProcAddr;
  dermis_context made = nullptr;
  const dermis_result result = dermis_context_create(&desc, &made);
  if (result != DERMIS_OK) return dermis_error("dermis_context_create", result);
  std::shared_ptr<dermis_context_t> owned(made, dermis_context_destroy);
  if (hooks.prepare)
    if (auto prepared = hooks.prepare(made); !prepared) return prepared;
  context = std::move(owned);
  return success();
}

} // namespace demo
