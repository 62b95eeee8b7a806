#pragma once
// The host's device as a value: handles, functions and the limits that running a plan needs. Owns nothing.

#include "framegraph/model/vocabulary.hpp"
#include "framegraph/vulkan/error.hpp"
#include "framegraph/vulkan/function_table.hpp"

#include <cstdint>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

enum class MemoryPurpose : uint8_t {
  transient, // means something from the first to the last command of a recorded frame only
  history,   // from frame to frame
  constants  // written by the host, read by kernels; counters that kernels write; stand-ins of what is not
             // bound
};

struct MemoryRequest {
  MemoryPurpose purpose = MemoryPurpose::transient;
  uint32_t memory_types = 0; // bit i: type i will do
  uint64_t bytes = 0;
  uint64_t alignment = 1; // of the block's offset; a power of two
  VkMemoryPropertyFlags required = 0, preferred = 0;
};

struct MemoryBlock {
  VkDeviceMemory memory = VK_NULL_HANDLE;
  uint64_t offset = 0;    // bytes
  void* mapped = nullptr; // where the block begins; host-visible memory alone
  void* user = nullptr;   // the host's
};

// A host's own heaps. Both must not throw.
struct HostMemory {
  VkResult (*take)(void* user, const MemoryRequest& request,
                   MemoryBlock& block) = nullptr; // null: use Vulkan
  void (*give_back)(void* user, const MemoryBlock& block) = nullptr;
  void* user = nullptr;
};

struct DeviceInput { // all handles belong to the host and must outlive the Device
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  // Vulkan 1.3 with synchronization2 and maintenance4 enabled, or 1.2 with the extensions of these names.
  VkDevice device = VK_NULL_HANDLE;
  const VkAllocationCallbacks* allocator = nullptr; // may be null; must outlive the Device
  uint32_t queue_family = 0;                        // of the command buffers that will be recorded into
  bool labels = false;                              // object names and debug labels; needs VK_EXT_debug_utils
  Features features = 0;                            // that the host enabled
  bool timings = false;                             // timestamps around each pass
  bool separate_depth_stencil = false;              // separateDepthStencilLayouts is enabled
  HostMemory host_memory{};
};

struct Device {
  FunctionTable vk;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  const VkAllocationCallbacks* allocator = nullptr;
  uint32_t queue_family = 0;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  uint32_t timestamp_valid_bits = 0; // of the queue family; 0: it cannot write timestamps
  Features features = 0;
  bool labels = false;
  bool timings = false; // asked for, and timestamp_valid_bits > 0
  bool separate_depth_stencil = false;
  HostMemory host_memory{};
};

// Fills `device`. Errors: argument (a null handle, a queue family that does not exist or cannot compute),
// unsupported (a physical device below Vulkan 1.2; every function the device does not give, all named in one
// text, with the instance's version or the extension that is the reason). `device` is unspecified on error.
// Free-threaded.
Error make_device(const DeviceInput& input, Device& device);

// Names an object for debuggers when `device.labels`; any text, copied. Free-threaded.
void name_object(const Device& device, VkObjectType type, uint64_t handle, const char* name);

} // namespace dermis::vulkan
