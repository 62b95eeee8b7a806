#include "integration/abi/requirements.hpp"

#include "integration/abi/failure.hpp"
#include "integration/abi/two_call.hpp"

namespace dermis::abi {
namespace {

dermis_requirement requirement(dermis_requirement_kind kind, const char* name, bool present,
                               const char* why) {
  dermis_requirement item = DERMIS_REQUIREMENT_INIT;
  item.kind = kind;
  item.name = name;
  item.required = 1;
  item.present = present ? 1 : 0;
  item.why = why;
  return item;
}

template <class Function>
Function load(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance, const char* name) {
  return reinterpret_cast<Function>(get_instance_proc_addr(instance, name));
}

} // namespace

std::array<dermis_requirement, requirement_count>
requirements_of(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                VkPhysicalDevice physical_device) {
  const auto get_properties = load<PFN_vkGetPhysicalDeviceProperties>(get_instance_proc_addr, instance,
                                                                      "vkGetPhysicalDeviceProperties");
  const auto get_features = load<PFN_vkGetPhysicalDeviceFeatures2>(get_instance_proc_addr, instance,
                                                                   "vkGetPhysicalDeviceFeatures2");
  uint32_t version = 0;
  if (get_properties != nullptr) {
    VkPhysicalDeviceProperties properties{};
    get_properties(physical_device, &properties);
    version = properties.apiVersion;
  }
  VkPhysicalDeviceVulkan12Features vulkan12{};
  vulkan12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
  VkPhysicalDeviceVulkan13Features vulkan13{};
  vulkan13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
  vulkan13.pNext = &vulkan12;
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.pNext = &vulkan13; // a device before 1.3 does not know the struct and leaves it at zero
  if (get_features != nullptr && version >= VK_API_VERSION_1_3) get_features(physical_device, &features);

  dermis_requirement api =
      requirement(DERMIS_REQUIREMENT_API_VERSION, "VK_API_VERSION_1_3", version >= VK_API_VERSION_1_3,
                  "the interface is written against Vulkan 1.3");
  api.version = VK_API_VERSION_1_3;
  const auto feature = [](const char* name, VkBool32 present, const char* why) {
    return requirement(DERMIS_REQUIREMENT_FEATURE, name, present == VK_TRUE, why);
  };
  return {api,
          feature("synchronization2", vulkan13.synchronization2,
                  "barriers are vkCmdPipelineBarrier2 with 64-bit masks"),
          feature("maintenance4", vulkan13.maintenance4,
                  "memory needs are asked before images exist; kernels use LocalSizeId"),
          feature("shaderStorageImageWriteWithoutFormat",
                  features.features.shaderStorageImageWriteWithoutFormat,
                  "a port accepts several image formats with one kernel")};
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL
dermis_query_requirements(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                          VkPhysicalDevice physical_device, uint32_t* count, dermis_requirement* items) {
  return guarded({}, "dermis_query_requirements", [&] {
    if (get_instance_proc_addr == nullptr)
      return bad_argument({}, "dermis_query_requirements: get_instance_proc_addr is NULL");
    if (instance == VK_NULL_HANDLE) return bad_argument({}, "dermis_query_requirements: instance is NULL");
    if (physical_device == VK_NULL_HANDLE)
      return bad_argument({}, "dermis_query_requirements: physical_device is NULL");
    const auto all = requirements_of(get_instance_proc_addr, instance, physical_device);
    return fill_array({}, "dermis_query_requirements", count, items, requirement_count,
                      [&](uint32_t i) { return all[i]; });
  });
}
