#include "integration/examples/demo_engine/device_survey.hpp"

#include "integration/examples/demo_engine/vulkan_instance.hpp"

#include <dermis/dermis.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace demo {
namespace {

const char* type_name(VkPhysicalDeviceType type) {
  switch (type) {
  case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
    return "discrete GPU";
  case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
    return "integrated GPU";
  case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
    return "virtual GPU";
  case VK_PHYSICAL_DEVICE_TYPE_CPU:
    return "CPU";
  default:
    return "other";
  }
}

bool queue_fits(VkPhysicalDevice device, bool& timestamps) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  const auto found =
      std::find_if(families.begin(), families.end(), [](const VkQueueFamilyProperties& family) {
        return (family.queueFlags & VK_QUEUE_COMPUTE_BIT) != 0;
      });
  timestamps = found != families.end() && found->timestampValidBits != 0;
  return found != families.end();
}

// Returns the requirements of the library itself on a device.
Result<std::vector<SurveyItem>> requirements_of(VkInstance instance, VkPhysicalDevice device) {
  std::array<dermis_requirement, 16> requested;
  requested.fill(DERMIS_REQUIREMENT_INIT);
  auto count = static_cast<uint32_t>(requested.size());
  if (dermis_query_requirements(vkGetInstanceProcAddr, instance, device, &count,
                                requested.data()) != DERMIS_OK)
    return Error{ErrorKind::internal, dermis_last_error()};
  std::vector<SurveyItem> items;
  for (uint32_t i = 0; i < count; ++i)
    items.push_back({requested[i].name, requested[i].present != 0, requested[i].required != 0,
                     requested[i].why});
  return items;
}

// Formats of light, depth and history in the shipped graphs.
struct SurveyedFormat {
  VkFormat format;
  const char* name;
  const char* use;
};
constexpr SurveyedFormat surveyed_formats[] = {
    {VK_FORMAT_R16G16B16A16_SFLOAT, "rgba16f storage images", "light and history"},
    {VK_FORMAT_R32_SFLOAT, "r32f storage images", "depth of pyramids"},
    {VK_FORMAT_R8_UINT, "r8_uint storage images", "profile ids of pyramids"},
};

void add_optional(VkPhysicalDevice device, bool timestamps, std::vector<SurveyItem>& items) {
  items.push_back({"timestamps", timestamps, false,
                   timestamps ? "times of passes; budgets learn from them"
                              : "no times of passes; budgets use only the calibration"});
  for (const SurveyedFormat& format : surveyed_formats) {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(device, format.format, &properties);
    constexpr VkFormatFeatureFlags needed =
        VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
    SurveyItem& item = items.emplace_back();
    item.name = format.name;
    item.present = (properties.optimalTilingFeatures & needed) == needed;
    item.why = item.present
                   ? std::string(format.use)
                   : fmt::format("{}; graphs that name no other format do not compile", format.use);
  }
}

Result<SurveyedDevice> survey(VkInstance instance, VkPhysicalDevice device) {
  auto driver = vulkan_struct<VkPhysicalDeviceDriverProperties>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
  auto properties =
      vulkan_struct<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
  vkGetPhysicalDeviceProperties(device, &properties.properties);
  SurveyedDevice seen;
  seen.api_version = properties.properties.apiVersion;
  if (seen.api_version >= VK_API_VERSION_1_2) {
    properties.pNext = &driver;
    vkGetPhysicalDeviceProperties2(device, &properties);
    seen.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
  }
  seen.name = properties.properties.deviceName;
  seen.type = type_name(properties.properties.deviceType);
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  for (uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if ((memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0)
      seen.memory_bytes = std::max<uint64_t>(seen.memory_bytes, memory.memoryHeaps[i].size);

  Result<std::vector<SurveyItem>> required = requirements_of(instance, device);
  if (!required) return required.error();
  seen.items = required.take();
  bool timestamps = false;
  const bool compute = queue_fits(device, timestamps);
  seen.items.push_back(
      {"a queue family with compute", compute, true, "everything is a compute shader"});
  add_optional(device, timestamps, seen.items);
  seen.fits = std::all_of(seen.items.begin(), seen.items.end(),
                          [](const SurveyItem& item) { return item.present || !item.required; });
  return seen;
}

Result<std::vector<SurveyedDevice>> survey_all(VkInstance instance) {
  const Result<ChosenDevice> chosen = choose_device(instance, {});
  std::vector<SurveyedDevice> all;
  for (VkPhysicalDevice device : all_devices(instance)) {
    Result<SurveyedDevice> seen = survey(instance, device);
    if (!seen) return seen.error();
    seen->chosen = chosen && chosen->device == device;
    all.push_back(seen.take());
  }
  return all;
}

} // namespace

Result<DeviceSurvey> survey_devices() {
  if (Result<> loaded = load_vulkan(); !loaded) return loaded.error();
  DeviceSurvey survey;
  survey.loader_version = volkGetInstanceVersion();
  survey.validation_layer = has_validation_layer();
  ValidationLog log;
  VulkanInstance made;
  if (Result<> created = create_instance({}, log, made); !created) return created.error();
  Result<std::vector<SurveyedDevice>> devices = survey_all(made.instance);
  vkDestroyInstance(made.instance, nullptr);
  if (!devices) return devices.error();
  survey.devices = devices.take();
  return survey;
}

} // namespace demo
