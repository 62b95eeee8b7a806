// Tests the host's device: format numbers are right, and sizes match the driver.
#include "framegraph/vulkan/create_infos.hpp"
#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {
namespace {

TEST(Vocabulary, FormatsHaveVulkansNumbers) {
  const std::pair<Format, VkFormat> pairs[] = {
      {Format::undefined, VK_FORMAT_UNDEFINED},
      {Format::r8_unorm, VK_FORMAT_R8_UNORM},
      {Format::r8_uint, VK_FORMAT_R8_UINT},
      {Format::r16_uint, VK_FORMAT_R16_UINT},
      {Format::r32_uint, VK_FORMAT_R32_UINT},
      {Format::r16f, VK_FORMAT_R16_SFLOAT},
      {Format::r32f, VK_FORMAT_R32_SFLOAT},
      {Format::rg8_unorm, VK_FORMAT_R8G8_UNORM},
      {Format::rg16f, VK_FORMAT_R16G16_SFLOAT},
      {Format::rg32f, VK_FORMAT_R32G32_SFLOAT},
      {Format::rg32_uint, VK_FORMAT_R32G32_UINT},
      {Format::rgba8_unorm, VK_FORMAT_R8G8B8A8_UNORM},
      {Format::rgba8_srgb, VK_FORMAT_R8G8B8A8_SRGB},
      {Format::rgba16f, VK_FORMAT_R16G16B16A16_SFLOAT},
      {Format::rgba32f, VK_FORMAT_R32G32B32A32_SFLOAT},
      {Format::rgba32_uint, VK_FORMAT_R32G32B32A32_UINT},
      {Format::b10g11r11f, VK_FORMAT_B10G11R11_UFLOAT_PACK32},
      {Format::d16, VK_FORMAT_D16_UNORM},
      {Format::d24, VK_FORMAT_X8_D24_UNORM_PACK32},
      {Format::d32f, VK_FORMAT_D32_SFLOAT},
      {Format::d24s8, VK_FORMAT_D24_UNORM_S8_UINT},
      {Format::d32fs8, VK_FORMAT_D32_SFLOAT_S8_UINT},
  };
  ASSERT_EQ(std::size(pairs), static_cast<size_t>(Format::count));
  for (const auto& [format, number] : pairs)
    EXPECT_EQ(vulkan::vk_format(format), number) << format_info(format).name;
}

TEST(Vocabulary, UsagesHaveVulkansBits) {
  EXPECT_EQ(usage_info(Usage::sampled_image).vk_usage, uint32_t{VK_IMAGE_USAGE_SAMPLED_BIT});
  EXPECT_EQ(usage_info(Usage::storage_image_write).vk_usage, uint32_t{VK_IMAGE_USAGE_STORAGE_BIT});
  EXPECT_EQ(usage_info(Usage::storage_image_update).vk_usage, uint32_t{VK_IMAGE_USAGE_STORAGE_BIT});
  EXPECT_EQ(usage_info(Usage::storage_buffer_read).vk_usage,
            uint32_t{VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
  EXPECT_EQ(usage_info(Usage::indirect_arguments).vk_usage,
            uint32_t{VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT});
  EXPECT_EQ(usage_info(Usage::clear).vk_usage, uint32_t{VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  EXPECT_EQ(usage_info(Usage::clear).vk_usage, uint32_t{VK_BUFFER_USAGE_TRANSFER_DST_BIT});
}

class DeviceTest : public ExecutorTest {
protected:
  vulkan::DeviceInput input() const { return device_input<vulkan::DeviceInput>(); }
};

TEST_F(DeviceTest, NullHandlesAndUnknownQueueFamiliesAreRejected) {
  vulkan::Device made;
  vulkan::DeviceInput in = input();
  in.device = VK_NULL_HANDLE;
  in.instance = VK_NULL_HANDLE;
  vulkan::Error error = vulkan::make_device(in, made);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::argument);
  EXPECT_THAT(error.text, HasSubstr("instance, device"));
  in = input();
  in.queue_family = 1000;
  error = vulkan::make_device(in, made);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::argument);
  EXPECT_THAT(error.text, HasSubstr("queue family 1000"));
}

TEST_F(DeviceTest, ProfileMatchesTheDriver) {
  EXPECT_EQ(profile.name, dermis_device.properties.deviceName);
  EXPECT_TRUE(
      profile.supports(Format::rgba16f, VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT))
      << "required of every Vulkan device";
  EXPECT_TRUE(profile.supports(Format::d32f, VK_IMAGE_USAGE_SAMPLED_BIT));
  EXPECT_FALSE(profile.supports(Format::rgba8_srgb, VK_IMAGE_USAGE_STORAGE_BIT))
      << "no driver here stores sRGB";
  EXPECT_FALSE(profile.supports(Format::undefined, VK_IMAGE_USAGE_SAMPLED_BIT));
  EXPECT_TRUE(profile.filters(Format::rgba16f)) << "required of every Vulkan device";
  EXPECT_FALSE(profile.filters(Format::r32_uint)) << "integers cannot be filtered";
  const MemoryNeeds image =
      profile.image_needs({Format::rgba16f, 100, 50, 1, 1, VK_IMAGE_USAGE_SAMPLED_BIT});
  EXPECT_GE(image.size, 100u * 50u * 8u);
  EXPECT_NE(image.memory_type_bits, 0u);
  const MemoryNeeds buffer = profile.buffer_needs({1000, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
  EXPECT_GE(buffer.size, 1000u);
  EXPECT_NE(buffer.memory_type_bits, 0u);
}

} // namespace
} // namespace dermis::testing
