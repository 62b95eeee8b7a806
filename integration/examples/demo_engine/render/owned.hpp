#pragma once
// Vulkan objects that are destroyed with their owner. They must be destroyed before their host.

#include "integration/examples/demo_engine/vulkan_host.hpp"

#include <utility>

namespace demo {

template <class Handle, auto destroy> struct Owned {
  const VulkanHost* host = nullptr;
  Handle handle = VK_NULL_HANDLE;

  Owned() = default;
  Owned(const VulkanHost& owner, Handle owned) : host(&owner), handle(owned) {}
  Owned(Owned&& other) noexcept { *this = std::move(other); }
  Owned& operator=(Owned&& other) noexcept {
    std::swap(host, other.host);
    std::swap(handle, other.handle);
    return *this;
  }
  ~Owned() {
    if (host) (host->vk.*destroy)(host->device, handle, nullptr);
  }
};

using OwnedPipeline = Owned<VkPipeline, &VolkDeviceTable::vkDestroyPipeline>;
using OwnedPipelineLayout = Owned<VkPipelineLayout, &VolkDeviceTable::vkDestroyPipelineLayout>;
using OwnedSetLayout = Owned<VkDescriptorSetLayout, &VolkDeviceTable::vkDestroyDescriptorSetLayout>;
using OwnedDescriptorPool = Owned<VkDescriptorPool, &VolkDeviceTable::vkDestroyDescriptorPool>;
using OwnedShader = Owned<VkShaderModule, &VolkDeviceTable::vkDestroyShaderModule>;
using OwnedSampler = Owned<VkSampler, &VolkDeviceTable::vkDestroySampler>;
using OwnedQueryPool = Owned<VkQueryPool, &VolkDeviceTable::vkDestroyQueryPool>;

} // namespace demo
