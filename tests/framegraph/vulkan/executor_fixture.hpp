#pragma once
// A device, an executor on it and named host images, for the device tests of this folder.

#include "framegraph/vulkan/device_profile.hpp"
#include "tests/framegraph/vulkan/small_graph.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/vulkan_fixture.hpp"

#include <map>

namespace dermis::testing {

class ExecutorTest : public VulkanTest {
protected:
  void SetUp() override;
  void TearDown() override;

  // Compiles `graph` for the device and makes the executor. Fails the test on errors.
  void make_executor(const SmallGraph& graph, uint32_t width, uint32_t height,
                     const std::vector<std::string>& unbound = {});
  vulkan::Error try_executor(const SmallGraph& graph, const Plan& plan, const vulkan::Device& on,
                             std::unique_ptr<vulkan::Executor>& result);
  // Makes the executor and binds a new image to the slot "result".
  TestImage start(const SmallGraph& graph, uint32_t width, uint32_t height);
  // Makes an r32f image of the frame's size and binds it to the slot; `layout` is its state before
  // and after a frame.
  TestImage bind(const SmallGraph& graph, const std::string& slot, const std::vector<float>& texels,
                 VkImageLayout layout = VK_IMAGE_LAYOUT_GENERAL);
  void bind_image(const SmallGraph& graph, const std::string& slot, const TestImage& image,
                  VkImageLayout before, VkImageLayout after);
  // Records and submits the next frame, without waiting.
  vulkan::RecordResult frame(float time = 0.0f, vulkan::Rectangle rectangle = {},
                             bool reset_history = false);
  void run_frames(uint32_t count);
  // Runs one frame per value and expects it in every texel.
  void expect_frames(const TestImage& image, const std::vector<float>& values);
  std::vector<float> read(const TestImage& image, VkImageLayout layout = VK_IMAGE_LAYOUT_GENERAL);

  vulkan::Device dermis_device;
  DeviceProfile profile;
  std::unique_ptr<vulkan::Executor> executor;
  std::unique_ptr<vulkan::Executor> replaced; // Value of FrameInput::before, or null.
  std::vector<vulkan::HostImage> images;      // By slot.
  std::vector<vulkan::HostBuffer> buffers;    // By slot.
  std::vector<SettingValue> settings;
  std::vector<std::vector<SettingValue>> prepared; // ExecutorInput::settings of the next executor.
  uint64_t frame_index = 0;
  bool poison = false;   // Applies to the next executor.
  bool counters = false; // Adds counters to the environment of the next executor.
  uint32_t view_width = 0, view_height = 0;
};

inline constexpr uint32_t test_frames_in_flight = 2;

} // namespace dermis::testing
