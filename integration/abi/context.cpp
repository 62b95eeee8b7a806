#include "integration/abi/context.hpp"

#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/missing_functions.hpp"
#include "integration/abi/requirements.hpp"
#include "passes/common/pass_types.hpp"

#include <algorithm>
#include <memory>

namespace dermis::abi {

dermis_result result_of(vulkan::ErrorKind kind) {
  switch (kind) {
  case vulkan::ErrorKind::none:
    return DERMIS_OK;
  case vulkan::ErrorKind::argument:
  case vulkan::ErrorKind::allocator:
    return DERMIS_ERROR_ARGUMENT;
  case vulkan::ErrorKind::unsupported:
    return DERMIS_ERROR_UNSUPPORTED;
  case vulkan::ErrorKind::shader:
    return DERMIS_ERROR_SHADER;
  case vulkan::ErrorKind::host_memory:
    return DERMIS_ERROR_MEMORY;
  case vulkan::ErrorKind::device_memory:
    return DERMIS_ERROR_DEVICE_MEMORY;
  case vulkan::ErrorKind::device_lost:
    return DERMIS_ERROR_DEVICE_LOST;
  case vulkan::ErrorKind::vulkan:
    break;
  }
  return DERMIS_ERROR_VULKAN;
}

DiagnosticId diagnostic_of(vulkan::ErrorKind kind) {
  switch (kind) {
  case vulkan::ErrorKind::argument:
  case vulkan::ErrorKind::allocator:
    return DiagnosticId::host_argument;
  case vulkan::ErrorKind::unsupported:
    return DiagnosticId::device_unsupported;
  case vulkan::ErrorKind::shader:
    return DiagnosticId::kernel_mismatch;
  case vulkan::ErrorKind::host_memory:
    return DiagnosticId::host_memory;
  case vulkan::ErrorKind::device_memory:
    return DiagnosticId::device_memory;
  case vulkan::ErrorKind::device_lost:
    return DiagnosticId::device_lost;
  case vulkan::ErrorKind::none:
  case vulkan::ErrorKind::vulkan:
    break;
  }
  return DiagnosticId::vulkan_call;
}

dermis_result check_alive(const dermis_context_t& context, const char* function) {
  if (!context.lost) return DERMIS_OK;
  return fail(context.log, DERMIS_ERROR_DEVICE_LOST, DiagnosticId::device_lost,
              "{}: the device was lost before", function);
}

namespace {

constexpr uint32_t known_context_flags =
    DERMIS_CONTEXT_TIMINGS | DERMIS_CONTEXT_LABELS | DERMIS_CONTEXT_RAY_QUERY |
    DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL | DERMIS_CONTEXT_GPU_KERNELS |
    DERMIS_CONTEXT_CPU_KERNELS | DERMIS_CONTEXT_SMALL_GROUPS | DERMIS_CONTEXT_SEPARATE_HISTORIES;

dermis_result check_desc(const dermis_context_desc& desc, const Log& log) {
  const auto null = [&](const char* field) {
    return bad_argument(log, "dermis_context_create: desc.{} is NULL", field);
  };
  if (desc.abi_version == 0 || desc.abi_version > DERMIS_ABI_VERSION)
    return fail(
        log, DERMIS_ERROR_VERSION, DiagnosticId::host_struct_version,
        "dermis_context_create: desc.abi_version is {}, this library supports versions 1..{}",
        desc.abi_version, DERMIS_ABI_VERSION);
  if ((desc.flags & ~known_context_flags) != 0)
    return bad_argument(log, "dermis_context_create: desc.flags is {:#x}, known bits are {:#x}",
                        desc.flags, known_context_flags);
  constexpr uint32_t both_shapes = DERMIS_CONTEXT_GPU_KERNELS | DERMIS_CONTEXT_CPU_KERNELS;
  if ((desc.flags & both_shapes) == both_shapes)
    return bad_argument(log, "dermis_context_create: desc.flags has DERMIS_CONTEXT_GPU_KERNELS and "
                             "DERMIS_CONTEXT_CPU_KERNELS, expected at most one of them");
  if (desc.frames_in_flight > vulkan::max_frames_in_flight)
    return bad_argument(
        log, "dermis_context_create: desc.frames_in_flight is {}, expected 0 (= {}) or 1..{}",
        desc.frames_in_flight, default_frames_in_flight, vulkan::max_frames_in_flight);
  if (desc.get_instance_proc_addr == nullptr) return null("get_instance_proc_addr");
  if (desc.instance == VK_NULL_HANDLE) return null("instance");
  if (desc.physical_device == VK_NULL_HANDLE) return null("physical_device");
  if (desc.device == VK_NULL_HANDLE) return null("device");
  return DERMIS_OK;
}

// Reports all missing requirements in one message.
dermis_result check_requirements(const dermis_context_desc& desc, const Log& log) {
  std::string missing;
  const bool rays = (desc.flags & DERMIS_CONTEXT_RAY_QUERY) != 0;
  const auto all =
      requirements_of(desc.get_instance_proc_addr, desc.instance, desc.physical_device);
  for (uint32_t i = 0; i < all.size(); ++i)
    if (const dermis_requirement& item = all[i];
        item.present == 0 && (item.required == 1 || (rays && i >= first_ray_requirement)))
      missing += fmt::format("{}{} ({})", missing.empty() ? "" : ", ", item.name, item.why);
  if (missing.empty()) return DERMIS_OK;
  VkPhysicalDeviceProperties properties{};
  if (const auto get = reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(
          desc.get_instance_proc_addr(desc.instance, "vkGetPhysicalDeviceProperties")))
    get(desc.physical_device, &properties);
  const auto get_device_proc_addr = reinterpret_cast<PFN_vkGetDeviceProcAddr>(
      desc.get_instance_proc_addr(desc.instance, "vkGetDeviceProcAddr"));
  if (const std::string reason =
          vulkan::explain_old_instance(get_device_proc_addr, desc.device, properties.apiVersion);
      !reason.empty())
    return fail(log, DERMIS_ERROR_UNSUPPORTED, DiagnosticId::device_unsupported,
                "dermis_context_create: {}", reason);
  return fail(log, DERMIS_ERROR_UNSUPPORTED, DiagnosticId::device_unsupported,
              "dermis_context_create: the physical device lacks {}", missing);
}

dermis_result read_allocators(const dermis_context_desc& desc, const Log& log, HostAllocator& host,
                              DeviceAllocator& device) {
  constexpr const char* function = "dermis_context_create";
  if (desc.allocator != nullptr) {
    dermis_allocator given = DERMIS_ALLOCATOR_INIT;
    if (const SizedRead read = read_sized(desc.allocator, given); read != SizedRead::ok)
      return rejected_size(log, read, function, "desc.allocator", stated_size(desc.allocator),
                           sizeof(dermis_allocator));
    if (given.allocate == nullptr || given.free == nullptr)
      return bad_argument(log, "{}: desc.allocator.{} is NULL", function,
                          given.allocate == nullptr ? "allocate" : "free");
    if (!serves_host_allocator())
      return fail(log, DERMIS_ERROR_UNSUPPORTED, DiagnosticId::device_unsupported,
                  "{}: desc.allocator works only in the shared library; here operator new belongs "
                  "to the program",
                  function);
    host = {given.allocate, given.free, given.user};
  }
  if (desc.device_allocator != nullptr) {
    dermis_device_allocator given = DERMIS_DEVICE_ALLOCATOR_INIT;
    if (const SizedRead read = read_sized(desc.device_allocator, given); read != SizedRead::ok)
      return rejected_size(log, read, function, "desc.device_allocator",
                           stated_size(desc.device_allocator), sizeof(dermis_device_allocator));
    if (given.allocate == nullptr || given.free == nullptr)
      return bad_argument(log, "{}: desc.device_allocator.{} is NULL", function,
                          given.allocate == nullptr ? "allocate" : "free");
    device = {given.allocate, given.free, given.user};
  }
  return DERMIS_OK;
}

dermis_result create(const dermis_context_desc& desc, const Log& log,
                     const DeviceAllocator& device_allocator, dermis_context* out) {
  auto context = std::make_unique<dermis_context_t>();
  context->log = log;
  context->device_allocator = device_allocator;
  if ((desc.flags & DERMIS_CONTEXT_SEPARATE_HISTORIES) != 0)
    context->history_memory = HistoryMemory::separate;
  vulkan::DeviceInput input;
  input.get_instance_proc_addr = desc.get_instance_proc_addr;
  input.instance = desc.instance;
  input.physical = desc.physical_device;
  input.device = desc.device;
  input.allocator = desc.vk_allocator;
  input.queue_family = desc.queue_family;
  input.labels = (desc.flags & DERMIS_CONTEXT_LABELS) != 0;
  if ((desc.flags & DERMIS_CONTEXT_RAY_QUERY) != 0) input.features |= bit_of(Feature::ray_query);
  input.separate_depth_stencil = (desc.flags & DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL) != 0;
  if ((desc.flags & DERMIS_CONTEXT_GPU_KERNELS) != 0)
    input.kernel_shape = vulkan::KernelShape::texel;
  if ((desc.flags & DERMIS_CONTEXT_CPU_KERNELS) != 0)
    input.kernel_shape = vulkan::KernelShape::block;
  input.small_groups = (desc.flags & DERMIS_CONTEXT_SMALL_GROUPS) != 0;
  input.timings = (desc.flags & DERMIS_CONTEXT_TIMINGS) != 0;
  input.host_memory = host_memory_of(context->device_allocator);
  if (const vulkan::Error error = vulkan::make_device(input, context->device))
    return fail(log, result_of(error.kind), diagnostic_of(error.kind), "dermis_context_create: {}",
                error.text);
  context->device.vk.vkGetPhysicalDeviceQueueFamilyProperties(
      desc.physical_device, &context->queue_family_count, nullptr);
  context->has_foreign_queues =
      has_device_extension(desc.get_instance_proc_addr, desc.instance, desc.physical_device,
                           VK_EXT_QUEUE_FAMILY_FOREIGN_EXTENSION_NAME);
  context->profile = vulkan::device_profile(context->device);
  context->pass_types = subsurface::make_pass_types();
  context->pipeline_cache = desc.pipeline_cache;
  context->frames_in_flight =
      desc.frames_in_flight == 0 ? default_frames_in_flight : desc.frames_in_flight;
  *out = context.release();
  return DERMIS_OK;
}

dermis_result create(const dermis_context_desc* given, dermis_context* out) {
  if (out == nullptr) return bad_argument({}, "dermis_context_create: context is NULL");
  *out = nullptr;
  if (given == nullptr) return bad_argument({}, "dermis_context_create: desc is NULL");
  dermis_context_desc desc = DERMIS_CONTEXT_DESC_INIT;
  if (const SizedRead read = read_sized(given, desc); read != SizedRead::ok)
    return rejected_size({}, read, "dermis_context_create: desc", stated_size(given),
                         sizeof(dermis_context_desc));
  Log log{desc.log, desc.log_user};
  if (const dermis_result result = check_desc(desc, log); result != DERMIS_OK) return result;
  if (const dermis_result result = check_requirements(desc, log); result != DERMIS_OK)
    return result;

  DeviceAllocator device_allocator;
  if (const dermis_result result = read_allocators(desc, log, log.memory, device_allocator);
      result != DERMIS_OK)
    return result;
  // from here on with the host's allocator and log
  return guarded(log, "dermis_context_create",
                 [&] { return create(desc, log, device_allocator, out); });
}

} // namespace
} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_context_create(const dermis_context_desc* desc,
                                                           dermis_context* context) {
  return guarded({}, "dermis_context_create", [&] { return create(desc, context); });
}

extern "C" void DERMIS_CALL dermis_context_destroy(dermis_context context) {
  if (context == nullptr) return;
  while (!context->graphs.empty()) {
    const dermis_graph graph = context->graphs.back();
    dermis_message message = DERMIS_MESSAGE_INIT;
    message.severity = DERMIS_SEVERITY_WARNING;
    const dermis::DiagnosticInfo& info =
        dermis::diagnostic_info(dermis::DiagnosticId::graph_leaked);
    message.code = static_cast<uint32_t>(info.id);
    message.code_name = info.name.data();
    message.file = "";
    message.pointer = "";
    message.text = "dermis_context_destroy: a graph of the context was not destroyed before it";
    message.hint = info.hint.data();
    send(context->log, message);
    dermis_graph_destroy(graph);
  }
  delete context;
}
