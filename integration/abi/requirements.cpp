#include "integration/abi/requirements.hpp"

#include "integration/abi/failure.hpp"
#include "integration/abi/two_call.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace dermis::abi {
namespace {

dermis_requirement requirement(dermis_requirement_type type, const char* name, bool present,
                               const char* why) {
  dermis_requirement item = DERMIS_REQUIREMENT_INIT;
  item.type = type;
  item.name = name;
  item.required = 1;
  item.present = present ? 1 : 0;
  item.why = why;
  return item;
}

template <class Function>
Function load(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
              const char* name) {
  return reinterpret_cast<Function>(get_instance_proc_addr(instance, name));
}

std::vector<std::string> extensions_of(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                       VkInstance instance, VkPhysicalDevice physical_device) {
  const auto enumerate = load<PFN_vkEnumerateDeviceExtensionProperties>(
      get_instance_proc_addr, instance, "vkEnumerateDeviceExtensionProperties");
  uint32_t count = 0;
  if (enumerate == nullptr || enumerate(physical_device, nullptr, &count, nullptr) != VK_SUCCESS)
    return {};
  std::vector<VkExtensionProperties> properties(count);
  if (enumerate(physical_device, nullptr, &count, properties.data()) != VK_SUCCESS) return {};
  std::vector<std::string> names;
  for (const VkExtensionProperties& one : properties)
    names.emplace_back(one.extensionName);
  return names;
}

bool has(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

constexpr const char* why_rays = "with DERMIS_CONTEXT_RAY_QUERY: passes that trace rays";

} // namespace

bool has_device_extension(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                          VkPhysicalDevice physical_device, std::string_view name) {
  return has(extensions_of(get_instance_proc_addr, instance, physical_device), name);
}

std::array<dermis_requirement, requirement_count>
requirements_of(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                VkPhysicalDevice physical_device) {
  const auto get_properties = load<PFN_vkGetPhysicalDeviceProperties>(
      get_instance_proc_addr, instance, "vkGetPhysicalDeviceProperties");
  const auto get_features = load<PFN_vkGetPhysicalDeviceFeatures2>(get_instance_proc_addr, instance,
                                                                   "vkGetPhysicalDeviceFeatures2");
  uint32_t version = 0;
  if (get_properties != nullptr) {
    VkPhysicalDeviceProperties properties{};
    get_properties(physical_device, &properties);
    version = properties.apiVersion;
  }
  const bool core = version >= VK_API_VERSION_1_3; // otherwise extensions of 1.2
  const std::vector<std::string> extensions =
      extensions_of(get_instance_proc_addr, instance, physical_device);
  const bool rays = has(extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME) &&
                    has(extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME);
  const bool has_synchronization2 =
      core || has(extensions, VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME);
  const bool has_maintenance4 = core || has(extensions, VK_KHR_MAINTENANCE_4_EXTENSION_NAME);
  VkPhysicalDeviceFeatures2 features{};
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  VkPhysicalDeviceSynchronization2Features synchronization2{};
  synchronization2.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES;
  VkPhysicalDeviceMaintenance4Features maintenance4{};
  maintenance4.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES;
  if (has_synchronization2) features.pNext = &synchronization2;
  if (has_maintenance4) {
    maintenance4.pNext = features.pNext;
    features.pNext = &maintenance4;
  }
  VkPhysicalDeviceAccelerationStructureFeaturesKHR structures{};
  structures.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR;
  VkPhysicalDeviceRayQueryFeaturesKHR queries{};
  queries.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR;
  if (rays) {
    structures.pNext = features.pNext;
    queries.pNext = &structures;
    features.pNext = &queries;
  }
  if (get_features != nullptr && version >= VK_API_VERSION_1_2)
    get_features(physical_device, &features);

  dermis_requirement api = requirement(
      DERMIS_REQUIREMENT_API_VERSION, "VK_API_VERSION_1_2", version >= VK_API_VERSION_1_2,
      "kernels are SPIR-V 1.5; with 1.3 the two extensions below are part of Vulkan");
  api.version = VK_API_VERSION_1_2;
  const auto extension = [&](const char* name, bool present, const char* why) {
    dermis_requirement item = requirement(DERMIS_REQUIREMENT_DEVICE_EXTENSION, name, present, why);
    item.required = core ? 0 : 1;
    return item;
  };
  const auto feature = [](const char* name, VkBool32 present, const char* why) {
    return requirement(DERMIS_REQUIREMENT_FEATURE, name, present == VK_TRUE, why);
  };
  const auto optional = [](dermis_requirement item) {
    item.required = 0;
    return item;
  };
  return {api,
          extension(
              VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME, has_synchronization2,
              "part of Vulkan 1.3; enable the extension only if you use the device as Vulkan 1.2"),
          extension(
              VK_KHR_MAINTENANCE_4_EXTENSION_NAME, has_maintenance4,
              "part of Vulkan 1.3; enable the extension only if you use the device as Vulkan 1.2"),
          feature("synchronization2", synchronization2.synchronization2,
                  "barriers are vkCmdPipelineBarrier2 with 64-bit masks"),
          feature("maintenance4", maintenance4.maintenance4,
                  "memory requirements are queried before images are created"),
          feature("shaderStorageImageWriteWithoutFormat",
                  features.features.shaderStorageImageWriteWithoutFormat,
                  "a port accepts several image formats with one kernel"),
          optional(requirement(
              DERMIS_REQUIREMENT_DEVICE_EXTENSION, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
              has(extensions, VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME), why_rays)),
          optional(requirement(DERMIS_REQUIREMENT_DEVICE_EXTENSION, VK_KHR_RAY_QUERY_EXTENSION_NAME,
                               has(extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME), why_rays)),
          optional(feature("accelerationStructure", structures.accelerationStructure, why_rays)),
          optional(feature("rayQuery", queries.rayQuery, why_rays))};
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_query_requirements(
    PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
    VkPhysicalDevice physical_device, uint32_t* count, dermis_requirement* items) {
  return guarded({}, "dermis_query_requirements", [&] {
    if (get_instance_proc_addr == nullptr)
      return bad_argument({}, "dermis_query_requirements: get_instance_proc_addr is NULL");
    if (instance == VK_NULL_HANDLE)
      return bad_argument({}, "dermis_query_requirements: instance is NULL");
    if (physical_device == VK_NULL_HANDLE)
      return bad_argument({}, "dermis_query_requirements: physical_device is NULL");
    const auto all = requirements_of(get_instance_proc_addr, instance, physical_device);
    return fill_array({}, "dermis_query_requirements", count, items, requirement_count,
                      [&](uint32_t i) { return all[i]; });
  });
}
