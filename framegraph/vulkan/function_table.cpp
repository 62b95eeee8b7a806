#include "framegraph/vulkan/function_table.hpp"

namespace dermis::vulkan {

std::vector<std::string> load_functions(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                                        VkDevice device, bool labels, FunctionTable& table) {
  std::vector<std::string> missing;
  table = {};
#define DERMIS_LOAD_INSTANCE(name)                                                                           \
  table.name = reinterpret_cast<PFN_##name>(get_instance_proc_addr(instance, #name));                        \
  if (table.name == nullptr) missing.push_back(#name);
#define DERMIS_LOAD_DEVICE(name)                                                                             \
  if (table.vkGetDeviceProcAddr != nullptr)                                                                  \
    table.name = reinterpret_cast<PFN_##name>(table.vkGetDeviceProcAddr(device, #name));                     \
  if (table.name == nullptr) missing.push_back(#name);
  DERMIS_INSTANCE_FUNCTIONS(DERMIS_LOAD_INSTANCE)
  DERMIS_DEVICE_FUNCTIONS(DERMIS_LOAD_DEVICE)
  if (labels) {
    // VK_EXT_debug_utils is an instance extension: some loaders give its functions for the instance only.
    DERMIS_LABEL_FUNCTIONS(DERMIS_LOAD_INSTANCE)
  }
#undef DERMIS_LOAD_INSTANCE
#undef DERMIS_LOAD_DEVICE
  return missing;
}

} // namespace dermis::vulkan
