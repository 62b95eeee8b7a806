#pragma once
// A Vulkan device that runs nothing: every function that the library asks for exists, makes handles,
// remembers what lives and counts commands. With it a graph is created and recorded where there is no driver,
// the time of recording is the library's own, and failures of a driver can be asked for.

#include <cstdint>
#include <memory>
#include <vulkan/vulkan_core.h>

namespace dermis {

struct NullDeviceState;

// Free-threaded, as Vulkan's are. The handles belong to the device and die with it.
class NullDevice {
public:
  NullDevice();
  ~NullDevice();
  NullDevice(const NullDevice&) = delete;
  NullDevice& operator=(const NullDevice&) = delete;

  // Answers every name of the library's function table; null for other names.
  static PFN_vkGetInstanceProcAddr loader();

  VkInstance instance() const;
  VkPhysicalDevice physical() const;
  VkDevice device() const;
  VkCommandBuffer command_buffer() const; // always recording; takes any number of commands

  // An image and a view of it as a host would bind them; they live as long as the device.
  VkImage make_image();
  VkImageView make_view();

  uint64_t commands() const;     // vkCmd... calls so far
  uint64_t barriers() const;     // vkCmdPipelineBarrier2 among them
  uint64_t alive() const;        // objects created through the functions and not destroyed
  uint64_t memory_bytes() const; // device memory allocated and not freed
  uint64_t creations() const;    // calls so far that make an object or allocate, failed ones included

  // Capabilities of its queue family; graphics, compute and transfer until it is called.
  void set_queue_flags(VkQueueFlags flags);
  // The call that is number `creation` from now, 1 being the next, fails with `result`; 0: none does.
  void fail_creation(uint64_t creation, VkResult result);
  // What asking for timestamps gives from now on.
  void fail_queries(VkResult result);

private:
  std::unique_ptr<NullDeviceState> state_;
};

} // namespace dermis
