#include "tests/integration/soak/object_counts.hpp"

#include <fmt/format.h>

#include <array>
#include <atomic>
#include <iterator>
#include <string_view>

namespace dermis::abi_test {
namespace {

// The kinds of objects that the library makes (framegraph/vulkan/function_table.hpp).
// clang-format off
#define SOAK_OBJECTS(X) \
  X(Image) X(ImageView) X(Buffer) X(Sampler) X(DescriptorSetLayout) X(DescriptorPool) X(PipelineLayout) \
  X(ShaderModule) X(QueryPool)
// clang-format on
enum Kind : size_t {
#define SOAK_KIND(name) kind_##name,
  SOAK_OBJECTS(SOAK_KIND)
#undef SOAK_KIND
      pass_type_pipeline,
  kind_count
};
constexpr std::array names = {
#define SOAK_NAME(name) std::string_view(#name),
    SOAK_OBJECTS(SOAK_NAME)
#undef SOAK_NAME
        std::string_view("Pipeline")};
static_assert(names.size() == kind_count);

const VolkDeviceTable* driver = nullptr;
std::array<std::atomic<uint64_t>, kind_count> made{}, gone{};

template <Kind kind, auto member> struct Counted;
template <Kind kind, class Info, class Handle,
          VkResult (VKAPI_PTR* VolkDeviceTable::*member)(VkDevice, const Info*,
                                                         const VkAllocationCallbacks*, Handle*)>
struct Counted<kind, member> { // Creates an object.
  static VKAPI_ATTR VkResult VKAPI_CALL call(VkDevice device, const Info* info,
                                             const VkAllocationCallbacks* allocator, Handle* out) {
    const VkResult result = (driver->*member)(device, info, allocator, out);
    made[kind] += result == VK_SUCCESS;
    return result;
  }
};
template <Kind kind, class Handle,
          void (VKAPI_PTR* VolkDeviceTable::*member)(VkDevice, Handle,
                                                     const VkAllocationCallbacks*)>
struct Counted<kind, member> { // Destroys an object.
  static VKAPI_ATTR void VKAPI_CALL call(VkDevice device, Handle handle,
                                         const VkAllocationCallbacks* allocator) {
    gone[kind] += handle != VK_NULL_HANDLE;
    (driver->*member)(device, handle, allocator);
  }
};

VKAPI_ATTR VkResult VKAPI_CALL create_pipelines(VkDevice device, VkPipelineCache cache,
                                                uint32_t count,
                                                const VkComputePipelineCreateInfo* infos,
                                                const VkAllocationCallbacks* allocator,
                                                VkPipeline* out) {
  const VkResult result =
      driver->vkCreateComputePipelines(device, cache, count, infos, allocator, out);
  for (uint32_t i = 0; i < count; ++i)
    made[pass_type_pipeline] += out[i] != VK_NULL_HANDLE;
  return result;
}

template <class Function> PFN_vkVoidFunction untyped(Function function) {
  return reinterpret_cast<PFN_vkVoidFunction>(function);
}

PFN_vkVoidFunction VKAPI_CALL counting_device_proc_addr(VkDevice device, const char* name) {
  const std::string_view requested = name;
#define SOAK_FIND(name)                                                                            \
  if (requested == "vkCreate" #name)                                                               \
    return untyped(&Counted<kind_##name, &VolkDeviceTable::vkCreate##name>::call);                 \
  if (requested == "vkDestroy" #name)                                                              \
    return untyped(&Counted<kind_##name, &VolkDeviceTable::vkDestroy##name>::call);
  SOAK_OBJECTS(SOAK_FIND)
#undef SOAK_FIND
  if (requested == "vkCreateComputePipelines") return untyped(&create_pipelines);
  if (requested == "vkDestroyPipeline")
    return untyped(&Counted<pass_type_pipeline, &VolkDeviceTable::vkDestroyPipeline>::call);
  return vkGetDeviceProcAddr(device, name);
}

PFN_vkVoidFunction VKAPI_CALL counting_proc_addr(VkInstance instance, const char* name) {
  if (std::string_view(name) == "vkGetDeviceProcAddr") return untyped(&counting_device_proc_addr);
  return vkGetInstanceProcAddr(instance, name);
}

} // namespace

PFN_vkGetInstanceProcAddr counting_loader(const demo::VulkanHost& host) {
  driver = &host.vk;
  return &counting_proc_addr;
}

ObjectCounts object_counts() {
  ObjectCounts out;
  for (size_t kind = 0; kind < kind_count; ++kind) {
    const uint64_t alive = made[kind] - gone[kind];
    out.made += made[kind];
    out.alive += alive;
    if (alive > 0)
      fmt::format_to(std::back_inserter(out.text), "{}{} {}s", out.text.empty() ? "" : ", ", alive,
                     names[kind]);
  }
  out.pipelines = made[pass_type_pipeline];
  out.alive_pipelines = made[pass_type_pipeline] - gone[pass_type_pipeline];
  if (out.text.empty()) out.text = "none";
  return out;
}

} // namespace dermis::abi_test
