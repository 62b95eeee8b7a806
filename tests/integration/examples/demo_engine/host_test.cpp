#include "integration/examples/demo_engine/vulkan_image.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace demo {
namespace {

TEST(PixelFormat, EveryFiniteHalfRoundTripsThroughFloat) {
  for (uint32_t bits = 0; bits < 0x10000u; ++bits) {
    const auto half = static_cast<uint16_t>(bits);
    if ((half & 0x7c00u) == 0x7c00u && (half & 0x3ffu) != 0) continue; // NaN
    EXPECT_EQ(half_from_float(float_from_half(half)), half);
  }
}

TEST(PixelFormat, HalvesAreRoundedToNearestAndTiesToEven) {
  // A tie; the lower value is even.
  EXPECT_EQ(half_from_float(1.0f + 0x1p-11f), 0x3c00u);
  // A tie; the upper value is even.
  EXPECT_EQ(half_from_float(1.0f + 3 * 0x1p-11f), 0x3c02u);
  EXPECT_EQ(half_from_float(1.0f + 0x1p-11f + 0x1p-20f), 0x3c01u); // Just above the tie.
  // The largest value that rounds down.
  EXPECT_EQ(half_from_float(65519.0f), 0x7bffu);
  EXPECT_EQ(half_from_float(65520.0f), 0x7c00u); // Overflows to infinity.
  // Half of the smallest value: tie to even.
  EXPECT_EQ(half_from_float(0x1p-25f), 0u);
  EXPECT_EQ(half_from_float(0x1.8p-25f), 1u);
  EXPECT_EQ(half_from_float(std::numeric_limits<float>::quiet_NaN()) & 0x7e00u, 0x7e00u);
}

TEST(PixelFormat, SrgbRoundTripIsTheIdentity) {
  // The curve's published constants leave a step of about 1e-7 between its two parts; fp32 pow adds
  // some ulp.
  for (int i = 0; i <= 1000; ++i) {
    const float x = static_cast<float>(i) / 1000.0f;
    EXPECT_NEAR(linear_from_srgb(srgb_from_linear(x)), x, 2e-6f);
  }
}

struct Host : ::testing::Test {
  void SetUp() override {
    auto made = create_vulkan_host({.validation = true, .device = ""});
    ASSERT_TRUE(made) << made.error().text;
    host = made.take();
  }
  void TearDown() override {
    if (host) {
      EXPECT_THAT(host->log.messages, testing::IsEmpty());
    }
  }
  std::unique_ptr<VulkanHost> host;
};

TEST_F(Host, FloatsRoundTripThroughEveryFormat) {
  constexpr uint32_t width = 5, height = 3;
  for (const VkFormat format :
       {VK_FORMAT_R8_UINT, VK_FORMAT_R8_UNORM, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_R8G8B8A8_SRGB,
        VK_FORMAT_R16_SFLOAT, VK_FORMAT_R16G16_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT,
        VK_FORMAT_R32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT, VK_FORMAT_B10G11R11_UFLOAT_PACK32,
        VK_FORMAT_D32_SFLOAT}) {
    const PixelFormat* known = find_pixel_format(format);
    ASSERT_NE(known, nullptr);
    VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    auto image =
        create_image(*host, {.format = format, .width = width, .height = height, .usage = usage});
    ASSERT_TRUE(image) << known->name << ": " << image.error().text;
    std::vector<float> texels(width * height * known->channels);
    for (size_t i = 0; i < texels.size(); ++i)
      texels[i] = static_cast<float>(i) / static_cast<float>(texels.size());
    const ImageState state = {VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                              VK_ACCESS_2_MEMORY_READ_BIT};
    auto uploaded = upload_image(*host, *image, texels, known->channels, state);
    ASSERT_TRUE(uploaded) << uploaded.error().text;
    auto back = read_image(*host, *image, state);
    ASSERT_TRUE(back) << back.error().text;
    const auto expected = decode_texels(*known, encode_texels(*known, texels, known->channels));
    EXPECT_EQ(*back, expected) << known->name;
  }
}

TEST_F(Host, ImagesBeyondDeviceLimitsAreRejectedByName) {
  auto none = create_image(*host, {.format = VK_FORMAT_R8_UINT,
                                   .width = 0,
                                   .height = 4,
                                   .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().kind, ErrorKind::usage);
  EXPECT_THAT(none.error().text, testing::HasSubstr("0x4"));
}

TEST(VulkanHost, UnknownDeviceName_ListsTheDevices) {
  auto made = create_vulkan_host({.validation = false, .device = "no such device"});
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::environment);
  EXPECT_THAT(made.error().text, testing::HasSubstr("no such device"));
}

} // namespace
} // namespace demo
