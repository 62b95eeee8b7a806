#pragma once
// The host side of Vulkan without a window: instance, device, one queue, and the wait for its work.
// This is what an engine has before it embeds Dermis. Also keeps the contexts made for this device.

#include "integration/examples/demo_engine/vulkan_instance.hpp"

#include <functional>
#include <memory>

struct dermis_context_t;

namespace demo {

// Owns instance, device and a command pool. Images, buffers and pipelines of the host must be
// destroyed before it. One thread at a time.
struct VulkanHost {
  VkInstance instance = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
  VkPhysicalDevice physical_device = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  VkPhysicalDeviceMemoryProperties memory{};
  VkDevice device = VK_NULL_HANDLE;
  VolkDeviceTable vk{};
  uint32_t queue_family = 0; // graphics and compute
  VkQueue queue = VK_NULL_HANDLE;
  VkCommandPool pool = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
  KernelShape kernels = KernelShape::by_device;
  bool ray_query = false; // VK_KHR_ray_query and VK_KHR_acceleration_structure are enabled
  // VK_KHR_pipeline_executable_properties is enabled; only with HostOptions::compile_only
  bool pipeline_statistics = false;
  uint64_t timestamp_mask = 0; // 0: the queue has no timestamps
  uint64_t last_image = 0;     // Image::id
  ValidationLog log;
  // Contexts shared by the graphs of the engine and by the graphs of tools; null until first
  // created.
  std::shared_ptr<dermis_context_t> engine_context, tool_context;

  VulkanHost() = default;
  VulkanHost(const VulkanHost&) = delete;
  VulkanHost& operator=(const VulkanHost&) = delete;
  ~VulkanHost();
};

// Enables every feature of Vulkan 1.0 to 1.3 that the device has, except robust buffer access (it
// costs time and hides defects). Errors: environment if there is no loader, no driver, no layer or
// no suitable device.
Result<std::unique_ptr<VulkanHost>> create_vulkan_host(const HostOptions& options);

// Records with `record`, submits and waits. Errors: environment (Vulkan failed), or what `record`
// returns.
Result<> run_commands(VulkanHost& host, const std::function<Result<>(VkCommandBuffer)>& record);

// Returns the index of a memory type with all `preferred` flags, else with `required`; UINT32_MAX
// if there is none.
uint32_t find_memory_type(const VulkanHost& host, uint32_t type_bits,
                          VkMemoryPropertyFlags preferred, VkMemoryPropertyFlags required);

} // namespace demo
