// Tests inputs of other engines: light that contains albedo, packed light, and profile ids in other
// images than r8_uint.

#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/integration/abi/example_shader.hpp"
#include "tests/support/shipped_graphs.hpp"

#include "material_ids.spv.h" // Needs the types of the headers above.

#include <algorithm>
#include <cmath>

namespace dermis::abi_test {
namespace {

constexpr uint32_t image_side = 64;
constexpr size_t image_pixels = size_t{image_side} * image_side;

struct InputFormats : DermisTest {
  static GraphOptions options_of(const std::string& graph) {
    GraphOptions options = shipped_options(dermis::shipped::graph_file(graph));
    options.unbound = {"albedo",   "scatter_scale", "scattered_light", "thickness", "back_lighting",
                       "velocity", "sampling",      "importance",      "normal"};
    return options;
  }

  // Returns the picture of one frame, RGB. The graph's frames are numbered from 1, so that all
  // graphs use equal samples.
  std::vector<float> picture(dermis_graph graph) {
    last_frame = 0;
    dermis_frame one = bound_frame(graph);
    EXPECT_OK(record(graph, one));
    const uint32_t channels = demo::find_pixel_format(images.at("lighting").format)->channels;
    const std::vector<float> all = texels("lighting");
    std::vector<float> rgb;
    for (size_t i = 0; i < all.size(); ++i)
      if (i % channels < 3) rgb.push_back(all[i]);
    return rgb;
  }
};

float largest_gap(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  float largest = 0.0f;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// ---- Lighting that contains albedo

// A checkerboard of 8x8 squares; the dark squares of the blue channel are just above the floor of
// 1/64.
float albedo_at(uint32_t x, uint32_t y, uint32_t c) {
  const bool bright = ((x / 8 + y / 8) & 1) != 0;
  return bright ? 0.9f : c == 2 ? 0.02f : 0.2f;
}

std::vector<float> image_of(const std::function<float(uint32_t, uint32_t, uint32_t)>& value) {
  std::vector<float> texels;
  for (uint32_t y = 0; y < image_side; ++y)
    for (uint32_t x = 0; x < image_side; ++x)
      for (uint32_t c = 0; c < 4; ++c)
        texels.push_back(c == 3 ? 1.0f : value(x, y, c));
  return texels;
}

struct Demodulation : InputFormats, testing::WithParamInterface<const char*> {
  dermis_graph graph_with_albedo(const char* texturing) {
    GraphOptions options = options_of(GetParam());
    std::erase(options.unbound, "albedo");
    options.formats.emplace_back("lighting", VK_FORMAT_R32G32B32A32_SFLOAT);
    options.formats.emplace_back("albedo", VK_FORMAT_R32G32B32A32_SFLOAT);
    const dermis_graph graph = make_graph(options);
    const std::string json = '"' + std::string(texturing) + '"';
    EXPECT_OK(dermis_graph_set_setting(graph, "texturing", json.c_str(), nullptr));
    make_images(graph);
    upload("albedo", image_of(albedo_at));
    return graph;
  }
};

// Under even irradiance the light is unchanged for any texture, within two roundings to half floats
// (2^-11 each).
TEST_P(Demodulation, KeepsTextureUnderEvenLight) {
  const dermis_graph graph = graph_with_albedo("demodulate");
  const auto textured = [](uint32_t x, uint32_t y, uint32_t c) {
    return 0.5f * albedo_at(x, y, c);
  };
  upload("lighting", image_of(textured));
  const std::vector<float> shown = picture(graph);
  for (uint32_t y = 0, i = 0; y < image_side; ++y)
    for (uint32_t x = 0; x < image_side; ++x)
      for (uint32_t c = 0; c < 3; ++c, ++i) {
        ASSERT_NEAR(shown[i], textured(x, y, c), 0.5f * 0x1p-10f) << x << " " << y << " " << c;
      }
}

// Lighting times albedo with `demodulate` equals irradiance with `post`.
TEST_P(Demodulation, EqualsIrradianceTexturedAfterwards) {
  const auto irradiance = [](uint32_t x, uint32_t, uint32_t) {
    return x < image_side / 2 ? 1.0f : 0.25f;
  };
  const auto albedo = [](uint32_t x, uint32_t y, uint32_t) { return albedo_at(x, y, 0); };
  dermis_graph graph = graph_with_albedo("post");
  upload("albedo", image_of(albedo));
  upload("lighting", image_of(irradiance));
  const std::vector<float> expected = picture(graph);
  graph = graph_with_albedo("demodulate");
  upload("albedo", image_of(albedo));
  upload("lighting", image_of([&](uint32_t x, uint32_t y, uint32_t c) {
           return irradiance(x, y, c) * albedo(x, y, c);
         }));
  EXPECT_LT(largest_gap(picture(graph), expected), 2 * 0x1p-10f);
}

// Transmitted light gets albedo once, whether lighting contains albedo or not.
TEST_F(InputFormats, TransmittedLightGetsAlbedo) {
  std::vector<std::vector<float>> pictures;
  for (const char* texturing : {"\"post\"", "\"demodulate\""}) {
    GraphOptions options = options_of("sap");
    options.unbound = {"scatter_scale", "scattered_light"};
    for (const char* slot : {"lighting", "albedo", "back_lighting"})
      options.formats.emplace_back(slot, VK_FORMAT_R32G32B32A32_SFLOAT);
    const dermis_graph graph = make_graph(options);
    ASSERT_OK(dermis_graph_set_setting(graph, "texturing", texturing, nullptr));
    ASSERT_OK(dermis_graph_set_setting(graph, "transmission", "true", nullptr));
    make_images(graph);
    upload("albedo", image_of(albedo_at));
    fill("lighting", [](uint32_t, uint32_t) { return 0.0f; });
    fill("thickness", [](uint32_t, uint32_t) { return 0.0f; });
    fill("back_lighting", [](uint32_t x, uint32_t) { return x < 32 ? 1.0f : 0.25f; });
    pictures.push_back(picture(graph));
  }
  EXPECT_GT(*std::ranges::max_element(pictures[0]), 0.5f);
  EXPECT_LT(largest_gap(pictures[0], pictures[1]), 2 * 0x1p-10f);
}

INSTANTIATE_TEST_SUITE_P(Graphs, Demodulation, testing::Values("burley", "pyramid", "sap", "skin"),
                         [](const auto& one) { return std::string(one.param); });

// ---- Packed light

TEST_F(InputFormats, LightingMayBeB10g11r11) {
  VkFormatProperties properties{};
  vkGetPhysicalDeviceFormatProperties(host->physical_device, VK_FORMAT_B10G11R11_UFLOAT_PACK32,
                                      &properties);
  if ((properties.optimalTilingFeatures & VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT) == 0)
    GTEST_SKIP() << "this device cannot store to B10G11R11_UFLOAT_PACK32";
  std::vector<std::vector<float>> pictures;
  for (const VkFormat format : {VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_B10G11R11_UFLOAT_PACK32}) {
    GraphOptions options = options_of("sap");
    options.formats.emplace_back("lighting", format);
    const dermis_graph graph = make_bound_graph(options);
    pictures.push_back(picture(graph));
  }
  // Values up to 1 have 5 fraction bits (blue) and may be truncated.
  EXPECT_LT(largest_gap(pictures[0], pictures[1]), 0x1p-5f);
}

// ---- Profile ids

std::vector<float> striped_ids() { // Profile 1, none, and an id without a profile.
  std::vector<float> ids;
  for (uint32_t i = 0; i < image_pixels; ++i)
    ids.push_back(static_cast<float>(i % image_side / 24));
  return ids;
}

TEST_F(InputFormats, MaterialMayBeAnyUnsignedInteger) {
  for (const char* graph_name : {"burley", "sap"}) {
    std::vector<std::vector<float>> pictures;
    for (const VkFormat format : {VK_FORMAT_R8_UINT, VK_FORMAT_R16_UINT, VK_FORMAT_R32_UINT}) {
      GraphOptions options = options_of(graph_name);
      options.formats.emplace_back("material", format);
      const dermis_graph graph = make_bound_graph(options);
      upload("material", striped_ids());
      pictures.push_back(picture(graph));
    }
    EXPECT_EQ(pictures[1], pictures[0]) << graph_name << " r16_uint";
    EXPECT_EQ(pictures[2], pictures[0]) << graph_name << " r32_uint";
  }
}

// Id 257 is neither profile 1, its low byte, nor none.
TEST_F(InputFormats, MaterialIdsAbove255_CountAs255) {
  for (const char* graph_name : {"burley", "sap", "afis"}) {
    GraphOptions options = options_of(graph_name);
    options.formats.emplace_back("material", VK_FORMAT_R16_UINT);
    options.profile_count = 255;
    std::vector<std::vector<float>> pictures;
    for (const float id : {255.0f, 257.0f, 511.0f}) {
      const dermis_graph graph = make_bound_graph(options);
      fill("material", [&](uint32_t x, uint32_t) { return x / 4 % 2 == 0 ? id : 1.0f; });
      pictures.push_back(picture(graph));
    }
    EXPECT_EQ(pictures[1], pictures[0]) << graph_name;
    EXPECT_EQ(pictures[2], pictures[0]) << graph_name;
  }
}

// One would widen d of all pixels around.
TEST_F(InputFormats, InfiniteScatterScale_ActsAsZero) {
  for (const char* graph_name : {"burley", "sap", "separable", "afis"}) {
    GraphOptions options = options_of(graph_name);
    std::erase(options.unbound, "scatter_scale");
    options.formats.emplace_back("scatter_scale", VK_FORMAT_R16_SFLOAT);
    options.profile_count = 2;
    std::vector<std::vector<float>> pictures;
    for (const float scale : {0.0f, HUGE_VALF, 65504.0f}) {
      const dermis_graph graph = make_bound_graph(options);
      fill("lighting", [](uint32_t x, uint32_t y) { return (x / 3 + y / 5) % 2 == 0 ? 1 : 0.25f; });
      fill("material", [](uint32_t x, uint32_t y) { return (x / 20 + y / 12) % 2 == 0 ? 1 : 2; });
      fill("scatter_scale",
           [&](uint32_t x, uint32_t y) { return (x / 20 + y / 12) % 2 == 0 ? scale : 1; });
      pictures.push_back(picture(graph));
    }
    EXPECT_EQ(pictures[1], pictures[0]) << graph_name;
    EXPECT_EQ(pictures[2], pictures[0]) << graph_name;
  }
}

// Texels without subsurface in tiles that scatter: old light must not come from there.
TEST_F(InputFormats, PartialScattering_ReadsNoLightOfEarlierFrames) {
  dermis_graph graph = nullptr;
  const auto make = [&] {
    graph = make_graph(options_of("skin"));
    ASSERT_OK(dermis_graph_set_setting(graph, "technique", "\"partial\"", nullptr));
    make_images(graph);
  };
  const auto fill_stripes = [&] {
    fill("material", [](uint32_t, uint32_t y) { return y / 4 % 2 == 0 ? 0.0f : 1.0f; });
    fill("lighting", [](uint32_t x, uint32_t) { return x % 5 == 0 ? 1.0f : 0.25f; });
  };
  make();
  fill_stripes();
  picture(graph);
  const std::vector<float> expected = texels("lighting");
  make();
  fill("lighting", [](uint32_t, uint32_t) { return 16.0f; });
  picture(graph);
  fill_stripes();
  dermis_frame cut = bound_frame(graph);
  cut.flags |= DERMIS_FRAME_RESET_HISTORY;
  ASSERT_OK(record(graph, cut));
  expect_equal_rgb(texels("lighting"), expected);
}

// Runs integration/examples/material_ids.comp over `source` into the image of slot `material`.
struct IdExtraction : InputFormats {
  void extract_ids(VkImageView source, int32_t first_bit, int32_t bits) {
    const std::array<int32_t, 2> field{first_bit, bits};
    run_example(
        *host,
        {material_ids_spirv, {source}, &images.at("material"), std::as_bytes(std::span(field))});
  }

  // The host's own pass needs the image for `material` as a storage image, too.
  void make_graph_with_cleared_ids() {
    make_images(make_graph(options_of("burley")));
    demo::ImageDesc desc;
    desc.format = VK_FORMAT_R8_UINT;
    desc.width = desc.height = image_side;
    desc.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    auto material = demo::create_image(*host, desc);
    ASSERT_TRUE(material) << material.error().text;
    images["material"] = material.take();
    fill("material", [](uint32_t, uint32_t) { return 0.0f; });
  }
};

TEST_F(IdExtraction, FromABitFieldOfAPackedImage) {
  make_graph_with_cleared_ids();
  demo::ImageDesc desc;
  desc.format = VK_FORMAT_R32_UINT;
  desc.width = desc.height = image_side;
  desc.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  auto packed = demo::create_image(*host, desc);
  ASSERT_TRUE(packed) << packed.error().text;
  std::vector<float> values;
  for (const float id : striped_ids())
    values.push_back(id * 4096.0f + 5.0f); // Bits 12 to 15; other bits hold other data.
  const demo::ImageState general{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                 VK_ACCESS_2_MEMORY_READ_BIT};
  ASSERT_TRUE(demo::upload_image(*host, *packed, values, 1, general));
  extract_ids(packed->view, 12, 4);
  EXPECT_EQ(texels("material"), striped_ids());
}

TEST_F(IdExtraction, FromStencil) {
  make_graph_with_cleared_ids();
  VkImageCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
  info.imageType = VK_IMAGE_TYPE_2D;
  info.extent = {image_side, image_side, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VK_SAMPLE_COUNT_1_BIT;
  info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
  for (const VkFormat format : {VK_FORMAT_D24_UNORM_S8_UINT, VK_FORMAT_D32_SFLOAT_S8_UINT}) {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(host->physical_device, format, &properties);
    if ((properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT) != 0)
      info.format = format;
  }
  ASSERT_NE(info.format, VK_FORMAT_UNDEFINED) << "every device has one of these two";
  VkImage image = VK_NULL_HANDLE;
  ASSERT_EQ(host->vk.vkCreateImage(host->device, &info, nullptr, &image), VK_SUCCESS);
  VkMemoryRequirements needs{};
  host->vk.vkGetImageMemoryRequirements(host->device, image, &needs);
  VkMemoryAllocateInfo allocation{};
  allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
  allocation.allocationSize = needs.size;
  while ((needs.memoryTypeBits >> allocation.memoryTypeIndex & 1u) == 0)
    ++allocation.memoryTypeIndex;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  ASSERT_EQ(host->vk.vkAllocateMemory(host->device, &allocation, nullptr, &memory), VK_SUCCESS);
  ASSERT_EQ(host->vk.vkBindImageMemory(host->device, image, memory, 0), VK_SUCCESS);
  VkImageViewCreateInfo view_info{};
  view_info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  view_info.image = image;
  view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view_info.format = info.format;
  view_info.subresourceRange = {VK_IMAGE_ASPECT_STENCIL_BIT, 0, 1, 0, 1};
  VkImageView view = VK_NULL_HANDLE;
  ASSERT_EQ(host->vk.vkCreateImageView(host->device, &view_info, nullptr, &view), VK_SUCCESS);

  std::vector<std::byte> ids;
  for (const float id : striped_ids())
    ids.push_back(std::byte(static_cast<uint8_t>(id)));
  auto staging = demo::upload_buffer(*host, ids, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
  ASSERT_TRUE(staging) << staging.error().text;
  const auto filled = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
    VkImageMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT, 0, 1, 0,
                                1};
    VkDependencyInfo dependency{};
    dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &barrier;
    host->vk.vkCmdPipelineBarrier2(commands, &dependency);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_STENCIL_BIT, 0, 0, 1};
    copy.imageExtent = {image_side, image_side, 1};
    host->vk.vkCmdCopyBufferToImage(commands, staging->buffer, image, VK_IMAGE_LAYOUT_GENERAL, 1,
                                    &copy);
    barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    barrier.dstStageMask = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_GENERAL;
    host->vk.vkCmdPipelineBarrier2(commands, &dependency);
    return demo::success();
  });
  ASSERT_TRUE(filled) << filled.error().text;
  extract_ids(view, 0, 8);
  EXPECT_EQ(texels("material"), striped_ids());
  host->vk.vkDestroyImageView(host->device, view, nullptr);
  host->vk.vkDestroyImage(host->device, image, nullptr);
  host->vk.vkFreeMemory(host->device, memory, nullptr);
}

} // namespace
} // namespace dermis::abi_test
