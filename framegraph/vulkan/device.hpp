#pragma once
// Describes the host's device as a value: handles, functions and the limits that running a plan
// needs. Owns nothing.

#include "framegraph/model/vocabulary.hpp"
#include "framegraph/vulkan/error.hpp"
#include "framegraph/vulkan/function_table.hpp"

#include <cstdint>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

enum class MemoryPurpose : uint8_t {
  transient, // contents are valid only within one recorded frame
  history,   // contents live from frame to frame
  // constants: tables that the CPU writes and kernels read, counters that kernels write, and
  // placeholders of unbound ports
  constants
};

struct MemoryRequest {
  MemoryPurpose purpose = MemoryPurpose::transient;
  uint32_t memory_types = 0; // bit i: memory type i is allowed
  uint64_t bytes = 0;
  uint64_t alignment = 1; // of the block's offset; a power of two
  VkMemoryPropertyFlags required = 0, preferred = 0;
};

struct MemoryBlock {
  VkDeviceMemory memory = VK_NULL_HANDLE;
  uint64_t offset = 0;    // bytes
  void* mapped = nullptr; // start of the block; only for host-visible memory
  void* user = nullptr;   // private to the host's allocator
};

// A host's own device memory allocator. Neither function may throw.
struct HostMemory {
  VkResult (*allocate)(void* user, const MemoryRequest& request,
                       MemoryBlock& block) = nullptr; // null: memory comes from Vulkan
  void (*free)(void* user, const MemoryBlock& block) = nullptr;
  void* user = nullptr;
};

// How kernels divide work among invocations (shaders/common/shape.glsl).
enum class KernelShape : uint8_t {
  by_device, // block for devices of type CPU, otherwise texel
  texel,     // one texel per invocation, shared memory
  block      // blocks of texels per invocation, inputs not in shared memory
};

// All handles belong to the host and must outlive the Device.
struct DeviceInput {
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  // Must be Vulkan 1.3 with synchronization2 and maintenance4 enabled, or 1.2 with
  // VK_KHR_synchronization2 and VK_KHR_maintenance4.
  VkDevice device = VK_NULL_HANDLE;
  const VkAllocationCallbacks* allocator = nullptr; // may be null; must outlive the Device
  // of the command buffers that frames are recorded into
  uint32_t queue_family = 0;
  // object names and debug labels; needs VK_EXT_debug_utils
  bool labels = false;
  Features features = 0;               // that the host enabled
  bool timings = false;                // timestamps around each pass
  bool separate_depth_stencil = false; // separateDepthStencilLayouts is enabled
  KernelShape kernel_shape = KernelShape::by_device;
  bool small_groups = false; // of at most 128 invocations, whatever the device allows
  HostMemory host_memory{};
};

inline constexpr uint32_t wide_group_lanes = 512;

struct Device {
  FunctionTable vk;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  const VkAllocationCallbacks* allocator = nullptr;
  uint32_t queue_family = 0;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  uint32_t timestamp_valid_bits = 0; // of the queue family; 0: no timestamps
  Features features = 0;
  bool labels = false;
  bool timings = false; // requested, and timestamp_valid_bits > 0
  bool separate_depth_stencil = false;
  bool texel_shape = true; // of kernels
  // Some kernels have groups of wide_group_lanes invocations, with up to 32 KiB of shared memory.
  bool wide_groups = true;
  HostMemory host_memory{};
};

// Fills `device`. Errors:
// - argument: a handle is null, or the queue family does not exist or cannot compute.
// - unsupported: the physical device is below Vulkan 1.2, or functions are missing. The text names
//   all missing functions and the cause: the instance's version or an extension.
//
// `device` is unspecified on error. Free-threaded.
Error make_device(const DeviceInput& input, Device& device);

// Names an object for debuggers if `device.labels` is set. `name` is copied. Free-threaded.
void name_object(const Device& device, VkObjectType type, uint64_t handle, const char* name);

} // namespace dermis::vulkan
