#pragma once
// A Vulkan device that executes nothing. Every function that the library loads exists, creates
// handles, tracks live objects and counts commands. Graphs can be created and recorded without a
// driver, recording time measures only the library, and driver failures can be injected.

#include <cstdint>
#include <memory>
#include <vulkan/vulkan_core.h>

namespace dermis {

struct NullDeviceState;

// Thread safe, as Vulkan requires. Handles belong to the device and are destroyed with it.
class NullDevice {
public:
  NullDevice();
  ~NullDevice();
  NullDevice(const NullDevice&) = delete;
  NullDevice& operator=(const NullDevice&) = delete;

  // Resolves every name of the library's function table; returns null for other names.
  static PFN_vkGetInstanceProcAddr loader();

  VkInstance instance() const;
  VkPhysicalDevice physical() const;
  VkDevice device() const;
  VkCommandBuffer command_buffer() const; // always recording; accepts any number of commands

  // Create an image and an image view for a host to bind. Both live as long as the device.
  VkImage make_image();
  VkImageView make_view();

  uint64_t commands() const;          // number of vkCmd... calls
  uint64_t barriers() const;          // number of vkCmdPipelineBarrier2 calls
  uint64_t dispatches() const;        // number of vkCmdDispatch and vkCmdDispatchIndirect calls
  uint64_t buffer_copies() const;     // number of vkCmdCopyBuffer calls
  uint64_t descriptor_writes() const; // number of descriptors that vkUpdateDescriptorSets wrote
  uint64_t pipelines() const;         // number of pipelines created so far
  uint64_t alive() const;             // objects created through the functions and not yet destroyed
  uint64_t memory_bytes() const;      // device memory allocated and not yet freed, bytes
  uint64_t creations() const; // calls that create an object or allocate, including failed calls

  // Makes device-local memory invisible to the host. Call it before contexts are created.
  void make_discrete();
  // As make_discrete, with a heap of 256 MiB that is device-local and host-visible, but full.
  void make_discrete_with_full_bar();
  // Sets the capabilities of the queue family. Default: graphics, compute and transfer.
  void set_queue_flags(VkQueueFlags flags);
  // Makes the creation call number `creation` from now (1 is the next) fail with `result`. 0
  // disables the failure.
  void fail_creation(uint64_t creation, VkResult result);
  // Sets the result of all further timestamp queries.
  void fail_queries(VkResult result);

private:
  std::unique_ptr<NullDeviceState> state_;
};

} // namespace dermis
