#pragma once
// A headless Vulkan device for tests, always under Khronos validation with core and synchronization
// checks, also across submissions. Every message fails the test. Without a driver or layer the test
// is skipped with the reason.

#include <cstddef>
#include <cstdint>
#include <gtest/gtest.h>
#include <memory>
#include <span>
#include <string>
#include <vector>
#include <vulkan/vulkan_core.h>

namespace dermis::testing {

struct TestImage {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE; // View of mip 0; of the depth aspect for depth formats.
  VkDeviceMemory memory = VK_NULL_HANDLE;
  VkFormat format = VK_FORMAT_UNDEFINED;
  uint32_t width = 0, height = 0;
  uint32_t texel_bytes = 0;
};

class VulkanTest : public ::testing::Test {
public:
  VulkanTest();
  ~VulkanTest() override;

protected:
  void SetUp() override;
  void TearDown() override; // Waits, frees, and expects no validation messages.

  // Adds transfer usage; TearDown frees the image. Contents and layout are undefined.
  TestImage make_image(VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage);
  // Makes a buffer in host memory with these contents; TearDown frees it.
  VkBuffer make_buffer(std::span<const std::byte> contents, VkBufferUsageFlags usage);
  // Fills mip 0 with texels, row by row, and leaves the image in `layout`. Waits.
  void upload(const TestImage& image, std::span<const std::byte> texels, VkImageLayout layout);
  // Moves the image to `layout`; the contents are undefined. Waits.
  void transition(const TestImage& image, VkImageLayout layout);
  // Returns the texels of mip 0; the image is in `layout` before and after. Waits for the device.
  std::vector<std::byte> download(const TestImage& image, VkImageLayout layout);

  VkCommandBuffer begin_commands();      // Returns a new command buffer in the recording state.
  void submit(VkCommandBuffer commands); // Ends and submits without waiting.
  void wait();                           // Waits for the device to be idle.

  // Returns and clears the validation messages since the last call, for tests that cause them.
  std::vector<std::string> take_messages();

  // Returns the device input of the library; Input is vulkan::DeviceInput, which this file does not
  // include.
  template <typename Input> Input device_input() const {
    Input input;
    input.get_instance_proc_addr = get_instance_proc_addr;
    input.instance = instance;
    input.physical = physical;
    input.device = device;
    input.queue_family = queue_family;
    return input;
  }

  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;
  VkInstance instance = VK_NULL_HANDLE;
  VkPhysicalDevice physical = VK_NULL_HANDLE;
  VkDevice device = VK_NULL_HANDLE;
  VkQueue queue = VK_NULL_HANDLE;
  uint32_t queue_family = 0;

private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

template <class T> std::span<const std::byte> bytes_of(const std::vector<T>& values) {
  return std::as_bytes(std::span<const T>(values));
}
template <class T> std::vector<T> values_of(const std::vector<std::byte>& bytes) {
  std::vector<T> values(bytes.size() / sizeof(T));
  const auto* first = reinterpret_cast<const T*>(bytes.data());
  values.assign(first, first + values.size());
  return values;
}

} // namespace dermis::testing
