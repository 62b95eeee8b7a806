#include "framegraph/vulkan/missing_functions.hpp"

#include "framegraph/vulkan/function_table.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string_view>

namespace dermis::vulkan {
namespace {

// Names device functions that were promoted to core Vulkan together with one extension.
struct Group {
  const char* extension;
  uint32_t core_version;
  std::array<std::string_view, 2> functions;
};

constexpr Group groups[] = {
    {VK_KHR_BIND_MEMORY_2_EXTENSION_NAME,
     VK_API_VERSION_1_1,
     {"vkBindImageMemory2", "vkBindBufferMemory2"}},
    {VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME,
     VK_API_VERSION_1_3,
     {"vkCmdPipelineBarrier2", "vkCmdWriteTimestamp2"}},
    {VK_KHR_MAINTENANCE_4_EXTENSION_NAME,
     VK_API_VERSION_1_3,
     {"vkGetDeviceImageMemoryRequirements", "vkGetDeviceBufferMemoryRequirements"}},
};

bool contains(std::span<const std::string> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// A device that lacks only part of a group is faulty; neither version nor extension explains that.
bool is_absent(const Group& group, std::span<const std::string> missing) {
  return std::all_of(group.functions.begin(), group.functions.end(),
                     [&](std::string_view name) { return contains(missing, name); });
}

void append(std::string& list, std::string_view separator, std::string_view name) {
  if (!list.empty()) list += separator;
  list += name;
}

} // namespace

std::string explain_missing(std::span<const std::string> missing, uint32_t device_version) {
  std::string of_instance, of_extensions, extensions;
  std::vector<std::string> unexplained(missing.begin(), missing.end());
  const bool can_judge =
      device_version >= VK_API_VERSION_1_2 && !contains(missing, "vkGetDeviceProcAddr");
  for (const Group& group : groups) {
    if (!can_judge || !is_absent(group, missing)) continue;
    if (group.core_version > VK_API_VERSION_1_2) append(extensions, " and ", group.extension);
    for (const std::string_view name : group.functions) {
      append(group.core_version <= device_version ? of_instance : of_extensions, ", ", name);
      std::erase(unexplained, name);
    }
  }
  std::string of_labels;
#define DERMIS_TAKE(name)                                                                          \
  if (std::erase(unexplained, #name) > 0) append(of_labels, ", ", #name);
  DERMIS_LABEL_FUNCTIONS(DERMIS_TAKE)
#undef DERMIS_TAKE
  std::string text;
  if (!of_instance.empty())
    text =
        fmt::format("the device supports Vulkan {}.{}, but the instance was created for an older "
                    "version, which "
                    "hides {}; set VkApplicationInfo.apiVersion to VK_API_VERSION_1_3{}{}{}",
                    VK_API_VERSION_MAJOR(device_version), VK_API_VERSION_MINOR(device_version),
                    of_instance, extensions.empty() ? "" : ", or to VK_API_VERSION_1_2 and enable ",
                    extensions, extensions.empty() ? "" : " on the device");
  if (!of_extensions.empty())
    append(text, "; ",
           fmt::format("the device was created without the functions {}; enable {} in "
                       "VkDeviceCreateInfo.ppEnabledExtensionNames",
                       of_extensions, extensions));
  if (!of_labels.empty())
    append(
        text, "; ",
        fmt::format("labels need {}, of {}, which the instance was created without; enable it in "
                    "VkInstanceCreateInfo.ppEnabledExtensionNames, or ask for no labels",
                    of_labels, VK_EXT_DEBUG_UTILS_EXTENSION_NAME));
  if (!unexplained.empty())
    append(text, "; ",
           fmt::format("the device does not provide {} required function{}: {}", unexplained.size(),
                       unexplained.size() == 1 ? "" : "s", fmt::join(unexplained, ", ")));
  return text;
}

std::string explain_old_instance(PFN_vkGetDeviceProcAddr get_device_proc_addr, VkDevice device,
                                 uint32_t device_version) {
  constexpr const char* added_by_1_2 = "vkResetQueryPool";
  if (device_version < VK_API_VERSION_1_2 || get_device_proc_addr == nullptr ||
      get_device_proc_addr(device, added_by_1_2) != nullptr)
    return "";
  return fmt::format(
      "the device supports Vulkan {}.{}, but the instance was created for Vulkan 1.0 or 1.1, which "
      "does "
      "not allow the kernels' SPIR-V 1.5 and hides {}; set VkApplicationInfo.apiVersion to "
      "VK_API_VERSION_1_3, or to VK_API_VERSION_1_2 and enable {} and {} on the device",
      VK_API_VERSION_MAJOR(device_version), VK_API_VERSION_MINOR(device_version), added_by_1_2,
      VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME, VK_KHR_MAINTENANCE_4_EXTENSION_NAME);
}

} // namespace dermis::vulkan
