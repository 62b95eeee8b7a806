// Tests a host's combined depth-stencil images on a device: the validation layer accepts every
// barrier, and stencil keeps its contents.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <algorithm>

namespace dermis::abi_test {
namespace {

constexpr VkImageAspectFlags both_aspects = VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
constexpr uint32_t marked = 7; // Stencil value.

struct DepthLayouts {
  VkImageLayout before, after;
  bool depth_only; // Neither layouts nor barriers include stencil.
};

class DepthStencilImages : public DermisTest {
protected:
  static void make_host(bool separate) {
    auto made = demo::create_vulkan_host(
        {.validation = true, .device = "", .separate_depth_stencil = separate});
    if (made) host = made.take();
  }

  dermis_context context_with(uint32_t flags) {
    dermis_context_desc desc = context_desc();
    desc.flags |= flags;
    dermis_context made = nullptr;
    EXPECT_OK(dermis_context_create(&desc, &made));
    return made;
  }

  static bool can_sample(VkFormat format) {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(host->physical_device, format, &properties);
    constexpr VkFormatFeatureFlags needed =
        VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT;
    return (properties.optimalTilingFeatures & needed) == needed;
  }

  void move(VkCommandBuffer commands, VkImage image, VkImageAspectFlags aspects, VkImageLayout from,
            VkImageLayout to) {
    VkImageMemoryBarrier2 barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
    barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    barrier.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {aspects, 0, 1, 0, 1};
    VkDependencyInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
    info.imageMemoryBarrierCount = 1;
    info.pImageMemoryBarriers = &barrier;
    host->vk.vkCmdPipelineBarrier2(commands, &info);
  }

  // Clears to depth 0.5 and the stencil mark, in the layouts of the host.
  void clear(VkImage image, VkImageLayout depth, VkImageLayout stencil) {
    const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
      move(commands, image, both_aspects, VK_IMAGE_LAYOUT_UNDEFINED,
           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
      const VkClearDepthStencilValue value{0.5f, marked};
      const VkImageSubresourceRange range{both_aspects, 0, 1, 0, 1};
      host->vk.vkCmdClearDepthStencilImage(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                           &value, 1, &range);
      move_aspects(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, depth, stencil);
      return demo::success();
    });
    ASSERT_TRUE(ran) << ran.error().text;
  }

  void move_aspects(VkCommandBuffer commands, VkImage image, VkImageLayout depth_from,
                    VkImageLayout stencil_from, VkImageLayout depth_to, VkImageLayout stencil_to) {
    if (depth_from == stencil_from && depth_to == stencil_to)
      return move(commands, image, both_aspects, depth_from, depth_to);
    move(commands, image, VK_IMAGE_ASPECT_DEPTH_BIT, depth_from, depth_to);
    move(commands, image, VK_IMAGE_ASPECT_STENCIL_BIT, stencil_from, stencil_to);
  }

  std::vector<std::byte> read_stencil(const demo::Image& image, VkImageLayout depth,
                                      VkImageLayout stencil) {
    auto buffer = demo::create_buffer(*host, uint64_t{image.width} * image.height,
                                      VK_BUFFER_USAGE_TRANSFER_DST_BIT, true);
    EXPECT_TRUE(buffer) << buffer.error().text;
    const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
      constexpr VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
      move_aspects(commands, image.image, depth, stencil, source, source);
      VkBufferImageCopy region{};
      region.imageSubresource = {VK_IMAGE_ASPECT_STENCIL_BIT, 0, 0, 1};
      region.imageExtent = {image.width, image.height, 1};
      host->vk.vkCmdCopyImageToBuffer(commands, image.image, source, buffer->buffer, 1, &region);
      return demo::success();
    });
    EXPECT_TRUE(ran) << ran.error().text;
    const auto* first = static_cast<const std::byte*>(buffer->mapped);
    return {first, first + buffer->size};
  }

  static demo::Image make_depth(VkFormat format) {
    return make_depth_image(format, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT);
  }

  static std::vector<VkFormat> formats() {
    std::vector<VkFormat> found;
    for (const VkFormat format : {VK_FORMAT_D32_SFLOAT_S8_UINT, VK_FORMAT_D24_UNORM_S8_UINT})
      if (can_sample(format)) found.push_back(format);
    EXPECT_FALSE(found.empty()) << "Vulkan requires one of them";
    return found;
  }

  // Runs three frames on one image: from `before` to `after`, then from `after` to `after`.
  void run(VkFormat format, uint32_t flags, const DepthLayouts& layouts) {
    const dermis_context usual = context;
    context = context_with(flags);
    GraphOptions options;
    options.formats = {{"depth", format}};
    dermis_graph graph = nullptr;
    ASSERT_OK(create_graph(options, &graph));
    make_images(graph, "depth");
    images.insert_or_assign("depth", make_depth(format));
    const VkImage image = images.at("depth").image;
    const VkImageLayout stencil_rest =
        layouts.depth_only ? VK_IMAGE_LAYOUT_STENCIL_READ_ONLY_OPTIMAL : layouts.after;
    clear(image, layouts.before, layouts.depth_only ? stencil_rest : layouts.before);
    for (int i = 0; i < 3; ++i) {
      auto bound = bindings(graph);
      for (dermis_image_binding& binding : bound)
        if (binding.image == image) {
          binding.before = {i == 0 ? layouts.before : layouts.after, 0,
                            VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_WRITE_BIT, 0};
          binding.after = {layouts.after, 0, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                           VK_ACCESS_2_MEMORY_READ_BIT, 0};
        }
      dermis_frame one = frame(bound);
      one.depth_kind = DERMIS_DEPTH_DEVICE;
      ASSERT_OK(record(graph, one));
    }
    const std::vector<std::byte> stencil =
        read_stencil(images.at("depth"), layouts.after, stencil_rest);
    EXPECT_TRUE(std::all_of(stencil.begin(), stencil.end(),
                            [](std::byte texel) { return texel == std::byte{marked}; }));
    dermis_graph_destroy(graph);
    dermis_context_destroy(context);
    context = usual;
    images.clear();
    EXPECT_THAT(host->log.messages, IsEmpty());
  }
};

struct WithoutSeparateLayouts : DepthStencilImages {
  static void SetUpTestSuite() { make_host(false); }
};

TEST_F(WithoutSeparateLayouts, BothAspectsMove) {
  constexpr DepthLayouts cases[] = {
      {VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
       VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, false},
      {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
       VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, false},
      {VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, false}};
  for (const VkFormat format : formats())
    for (const DepthLayouts& layouts : cases)
      run(format, 0, layouts);
}

struct WithSeparateLayouts : DepthStencilImages {
  static void SetUpTestSuite() { make_host(true); }
};

TEST_F(WithSeparateLayouts, DepthLayouts_LeaveStencilUnchanged) {
  constexpr DepthLayouts cases[] = {
      {VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL, true},
      {VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL, true}};
  for (const VkFormat format : formats())
    for (const DepthLayouts& layouts : cases)
      for (const uint32_t flags : {0u, uint32_t{DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL}})
        run(format, flags, layouts);
}

TEST_F(WithSeparateLayouts, TheFlagMovesOnlyDepth) {
  constexpr DepthLayouts general{VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL, true};
  for (const VkFormat format : formats())
    run(format, DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL, general);
}

} // namespace
} // namespace dermis::abi_test
