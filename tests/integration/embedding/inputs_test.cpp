// Engines use different input formats with equal meaning: depth in any format and direction, and
// pre-exposed light.

#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::abi_test {
namespace {

constexpr float near_m = 0.1f, far_m = 10.0f; // Planes of the projections.
// Half of the picture's height at 1 m: 64 pixels of 1 mm there.
constexpr float slope = 0.032f;
const demo::ImageState resting{VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                               VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT};

enum class Direction : uint8_t { forward, reversed_infinite };

struct Inputs : DermisTest {
  // Returns a frame of a perspective camera that looks at a wall.
  dermis_frame wall_frame(const std::vector<dermis_image_binding>& bound, Direction direction) {
    dermis_frame one = frame(bound);
    std::ranges::fill(one.clip_from_view, 0.0f);
    one.clip_from_view[0] = 1 / slope;
    one.clip_from_view[5] = -1 / slope;
    one.clip_from_view[14] = -1;
    const bool forward = direction == Direction::forward; // depth = (a * -z + b) / -z
    one.clip_from_view[10] = forward ? -far_m / (far_m - near_m) : 0;
    one.clip_from_view[11] = forward ? -far_m * near_m / (far_m - near_m) : near_m;
    return one;
  }
  static float stored(float metres, Direction direction) {
    return direction == Direction::forward ? far_m / (far_m - near_m) * (1 - near_m / metres)
                                           : near_m / metres;
  }
  bool can_be(VkFormat format) const {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(host->physical_device, format, &properties);
    return (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT) != 0;
  }
  // Makes a depth buffer with one value, like a cleared one.
  static demo::Image depth_buffer(VkFormat format, VkImageUsageFlags usage, float value) {
    demo::Image image = make_depth_image(format, usage);
    const auto cleared = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
      demo::transition(*host, commands, image, {}, resting);
      const VkClearDepthStencilValue to{value, 0};
      const VkImageSubresourceRange all{image.aspect, 0, 1, 0, 1};
      host->vk.vkCmdClearDepthStencilImage(commands, image.image, VK_IMAGE_LAYOUT_GENERAL, &to, 1,
                                           &all);
      return demo::success();
    });
    EXPECT_TRUE(cleared) << cleared.error().text;
    return image;
  }
  // Returns the light on a wall `metres` away with this depth format and direction.
  std::vector<float> wall(VkFormat format, Direction direction, float metres) {
    GraphOptions options;
    // Without samples, so that pictures can be compared.
    options.text = read_text("configs/graphs/separable.json");
    options.formats = {{"depth", format}};
    const dermis_graph graph = make_graph(options);
    if (graph == nullptr) return {};
    VkImageUsageFlags usage = 0;
    for (const dermis_slot& slot : slots_of(graph))
      if (std::string(slot.name) == "depth") usage = slot.usage;
    make_images(graph, "depth");
    images.emplace("depth", depth_buffer(format, usage, stored(metres, direction)));
    const auto bound = bindings(graph);
    dermis_frame one = wall_frame(bound, direction);
    one.depth_kind = DERMIS_DEPTH_DEVICE;
    EXPECT_OK(record(graph, one));
    return texels("lighting");
  }
  // Returns the same light with view depths in a float image.
  std::vector<float> wall_in_units(float metres) {
    GraphOptions options = shipped_options("configs/graphs/separable.json");
    const dermis_graph graph = make_graph(options);
    if (graph == nullptr) return {};
    make_images(graph);
    fill("depth", [&](uint32_t, uint32_t) { return metres; });
    const auto bound = bindings(graph);
    dermis_frame one = wall_frame(bound, Direction::forward);
    EXPECT_OK(record(graph, one));
    return texels("lighting");
  }
};

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = a.size() == b.size() && !a.empty() ? 0 : HUGE_VAL;
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, std::abs(double(a[i]) - double(b[i])));
  return largest;
}

TEST_F(Inputs, DepthFormatsAndDirections_GiveEqualLight) {
  constexpr float metres = 0.5f;
  const auto expected = wall_in_units(metres);
  EXPECT_GT(largest_difference(expected, wall_in_units(2 * metres)), 0.02)
      << "the distance matters";
  uint32_t tried = 0;
  for (const VkFormat format :
       {VK_FORMAT_D32_SFLOAT, VK_FORMAT_X8_D24_UNORM_PACK32, VK_FORMAT_D16_UNORM,
        VK_FORMAT_D24_UNORM_S8_UINT, VK_FORMAT_D32_SFLOAT_S8_UINT}) {
    if (!can_be(format)) continue;
    ++tried;
    for (const Direction direction : {Direction::forward, Direction::reversed_infinite})
      // A step of d16 is 2^-16 of near * far / (far - near) / metres^2 = 0.4 per metre: 4e-5 m,
      // 8e-5 of the distance and of a kernel's width; light changes by less. The rest is one
      // rounding to half floats after each of three passes, 2^-12 each where light is 1.
      EXPECT_LT(largest_difference(wall(format, direction, metres), expected), 8e-5 + 3.0 / 4096)
          << "VkFormat " << format
          << (direction == Direction::forward ? ", forward" : ", reversed");
  }
  EXPECT_GE(tried, 3u) << "the software driver has at least d32f, d24 and d16";
}

// The picture does not depend on whether the host applies exposure before or after scattering, even
// if samples follow earlier frames.
TEST_F(Inputs, PreExposedLight_ScattersEqually) {
  constexpr float factor = 8; // A power of two keeps rounding equal.
  uint32_t told_apart = 0;
  for (const char* name : {"separable", "sap_residual", "afis_guided"}) {
    const auto frames = [&](float light, float exposure) {
      GraphOptions options = shipped_options(dermis::shipped::graph_file(name));
      for (const char* unbound : {"velocity", "thickness", "back_lighting"})
        options.unbound.emplace_back(unbound);
      const dermis_graph graph = make_graph(options);
      std::vector<float> last;
      if (graph == nullptr) return last;
      make_images(graph);
      last_frame = 0;
      for (int i = 0; i < 4; ++i) {
        // Dim enough that no sample or sum is clamped, bright enough that half floats stay normal.
        fill("lighting", [&](uint32_t x, uint32_t y) {
          return light * (0.125f + 0.25f * float((x / 8 + y / 8 + uint32_t(i)) % 2));
        });
        dermis_frame one = bound_frame(graph);
        one.exposure = exposure;
        for (const int diagonal : {0, 5, 10, 15}) // At rest: histories find their surfaces.
          one.view_from_world[diagonal] = 1;
        std::ranges::copy(one.clip_from_view, one.previous_clip_from_view);
        std::ranges::copy(one.view_from_world, one.previous_view_from_world);
        EXPECT_OK(record(graph, one));
      }
      return texels("lighting");
    };
    const auto after = frames(1, 1);
    const auto before = frames(factor, 1 / factor);
    ASSERT_EQ(after.size(), before.size());
    ASSERT_FALSE(after.empty()) << name;
    double largest = 0;
    for (size_t i = 0; i < after.size(); ++i)
      if (i % 4 != 3)
        largest = std::max(largest, std::abs(double(before[i]) / factor - double(after[i])));
    // The ratio compares logarithms of light, which round differently at another level: at most one
    // step of a half float between 0.25 and 0.5.
    EXPECT_LE(largest, std::string_view(name) == "sap_residual" ? 1.0 / 4096 : 0) << name;
    told_apart += frames(factor, 1) != before ? 1 : 0;
  }
  EXPECT_GT(told_apart, 0u) << "no graph reads the exposure, so this test proves nothing";
}

} // namespace
} // namespace dermis::abi_test
