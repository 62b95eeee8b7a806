// Tests which aspects the barriers of a combined depth-stencil image name.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

namespace dermis::abi_test {
namespace {

constexpr VkImageAspectFlags depth_only = VK_IMAGE_ASPECT_DEPTH_BIT,
                             both = VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;

struct Layouts {
  VkImageLayout before, after;
};

// Returns the aspects of all barriers on the depth image in one frame.
std::vector<VkImageAspectFlags> aspects(uint32_t flags, VkFormat depth_format,
                                        const Layouts& layouts) {
  NullHost host;
  dermis_context_desc context = host.context_desc();
  context.flags |= flags;
  EXPECT_OK(host.make_context(context));
  const std::string text = read_text("configs/graphs/burley.json");
  dermis_profile profile = skin_profile();
  dermis_slot_format format = slot_format("depth", depth_format);
  dermis_graph_desc desc = graph_desc(text, "burley.json", 64);
  desc.profiles = &profile;
  desc.profile_count = 1;
  desc.formats = &format;
  desc.format_count = 1;
  EXPECT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
  host.make_bindings();
  dermis_frame frame = host.frame_at(1);
  std::vector<dermis_image_binding> bindings(frame.bindings, frame.bindings + frame.binding_count);
  VkImage depth = VK_NULL_HANDLE;
  for (dermis_image_binding& binding : bindings)
    if (binding.format == depth_format) {
      binding.before.layout = layouts.before;
      binding.after.layout = layouts.after;
      depth = binding.image;
    }
  frame.bindings = bindings.data();
  uint32_t count = 0;
  const dermis_command* commands = nullptr;
  EXPECT_OK(dermis_view_commands(dermis_graph_view(host.graph), &frame, &count, &commands));
  std::vector<VkImageAspectFlags> found;
  for (uint32_t i = 0; i < count; ++i)
    for (uint32_t b = 0; commands[i].type == DERMIS_COMMAND_BARRIER &&
                         b < commands[i].dependency->imageMemoryBarrierCount;
         ++b)
      if (const VkImageMemoryBarrier2& one = commands[i].dependency->pImageMemoryBarriers[b];
          one.image == depth)
        found.push_back(one.subresourceRange.aspectMask);
  EXPECT_FALSE(found.empty());
  return found;
}

TEST(DepthStencil, BarriersNameTheAspectsOfTheLayouts) {
  constexpr VkImageLayout combined = VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
                          depth = VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL,
                          attachment = VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL;
  for (const VkFormat format : {VK_FORMAT_D32_SFLOAT_S8_UINT, VK_FORMAT_D24_UNORM_S8_UINT}) {
    EXPECT_THAT(aspects(0, format, {combined, combined}), Each(both));
    EXPECT_THAT(aspects(0, format, {depth, depth}), Each(depth_only));
    EXPECT_THAT(aspects(0, format, {attachment, combined}), Each(depth_only));
    EXPECT_THAT(aspects(0, format, {combined, depth}), Each(depth_only));
    EXPECT_THAT(aspects(DERMIS_CONTEXT_SEPARATE_DEPTH_STENCIL, format, {combined, combined}),
                Each(depth_only));
  }
  EXPECT_THAT(aspects(0, VK_FORMAT_D32_SFLOAT, {depth, depth}), Each(depth_only));
}

} // namespace
} // namespace dermis::abi_test
