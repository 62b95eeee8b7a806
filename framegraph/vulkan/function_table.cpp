#include "framegraph/vulkan/function_table.hpp"

namespace dermis::vulkan {

namespace {

// A Vulkan 1.2 device provides functions promoted to 1.3 under their extension names, with
// identical types.
PFN_vkVoidFunction find_device_function(const FunctionTable& table, VkDevice device,
                                        const char* name) {
  if (table.vkGetDeviceProcAddr == nullptr) return nullptr;
  if (const PFN_vkVoidFunction function = table.vkGetDeviceProcAddr(device, name)) return function;
  return table.vkGetDeviceProcAddr(device, (std::string(name) + "KHR").c_str());
}

} // namespace

std::vector<std::string> load_functions(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                        VkInstance instance, VkDevice device, bool labels,
                                        FunctionTable& table) {
  std::vector<std::string> missing;
  table = {};
#define DERMIS_LOAD_INSTANCE(name)                                                                 \
  table.name = reinterpret_cast<PFN_##name>(get_instance_proc_addr(instance, #name));              \
  if (table.name == nullptr) missing.push_back(#name);
#define DERMIS_LOAD_DEVICE(name)                                                                   \
  table.name = reinterpret_cast<PFN_##name>(find_device_function(table, device, #name));           \
  if (table.name == nullptr) missing.push_back(#name);
  DERMIS_INSTANCE_FUNCTIONS(DERMIS_LOAD_INSTANCE)
  DERMIS_DEVICE_FUNCTIONS(DERMIS_LOAD_DEVICE)
  if (labels) {
    // VK_EXT_debug_utils is an instance extension; some loaders provide its functions only for the
    // instance.
    DERMIS_LABEL_FUNCTIONS(DERMIS_LOAD_INSTANCE)
  }
#undef DERMIS_LOAD_INSTANCE
#undef DERMIS_LOAD_DEVICE
  return missing;
}

} // namespace dermis::vulkan
