// Tests slots that the frame's plan does not use: the host's accesses before and after the frame
// are ordered as the header promises.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/recorded_frame.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <span>
#include <utility>

namespace dermis::abi_test {
namespace {

struct UnusedSlots : RecordedFrame {
  static constexpr dermis_image_state written{VK_IMAGE_LAYOUT_GENERAL, 0,
                                              VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                              VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, 0};
  static constexpr dermis_image_state sampled{VK_IMAGE_LAYOUT_GENERAL, 0,
                                              VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                              VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, 0};

  void SetUp() override {
    RecordedFrame::SetUp();
    // Without a profile nothing scatters.
    ASSERT_OK(dermis_graph_set_profile(host.graph, 1, nullptr, nullptr));
  }
  // Returns the images of the slots that the plan does not use.
  std::set<VkImage> unused_images() {
    const auto slots = list_of(dermis_slot DERMIS_SLOT_INIT, dermis_graph_slots, host.graph);
    std::set<VkImage> images;
    for (const dermis_image_binding& binding : host.bindings())
      for (const dermis_slot& slot : slots)
        if (slot.id == binding.slot && slot.best_layout == VK_IMAGE_LAYOUT_UNDEFINED)
          images.insert(binding.image);
    EXPECT_GT(images.size(), 0u);
    return images;
  }
  // Returns the barriers of these images in a frame in which all bindings have these states.
  std::vector<VkImageMemoryBarrier2> barriers(const dermis_image_state& before,
                                              const dermis_image_state& after) {
    for (dermis_image_binding& binding : host.bindings()) {
      binding.before = before;
      binding.after = after;
    }
    const dermis_frame frame = host.frame_at(host.last_frame + 1);
    uint32_t count = 0;
    const dermis_command* list = nullptr;
    EXPECT_OK(dermis_view_commands(dermis_graph_view(host.graph), &frame, &count, &list));
    std::vector<VkImageMemoryBarrier2> found;
    const auto is_unused = [images = unused_images()](const VkImageMemoryBarrier2& one) {
      return images.contains(one.image);
    };
    for (uint32_t i = 0; i < count; ++i)
      if (list[i].type == DERMIS_COMMAND_BARRIER)
        std::ranges::copy_if(std::span(list[i].dependency->pImageMemoryBarriers,
                                       list[i].dependency->imageMemoryBarrierCount),
                             std::back_inserter(found), is_unused);
    EXPECT_OK(dermis_view_discard(dermis_graph_view(host.graph), frame.frame_index));
    return found;
  }
};

TEST_F(UnusedSlots, ReadAfterWrite_HasABarrier) {
  const std::vector<VkImageMemoryBarrier2> found = barriers(written, sampled);
  ASSERT_EQ(found.size(), unused_images().size());
  for (const VkImageMemoryBarrier2& one : found) {
    EXPECT_EQ(one.srcStageMask, written.stages);
    EXPECT_EQ(one.srcAccessMask, written.access);
    EXPECT_EQ(one.dstStageMask, sampled.stages);
    EXPECT_EQ(one.dstAccessMask, sampled.access);
    EXPECT_EQ(one.oldLayout, VK_IMAGE_LAYOUT_GENERAL);
    EXPECT_EQ(one.newLayout, VK_IMAGE_LAYOUT_GENERAL);
  }
}

TEST_F(UnusedSlots, EqualReads_HaveNoBarrier) {
  const size_t all = unused_images().size();
  EXPECT_EQ(barriers(sampled, sampled).size(), 0u);
  EXPECT_EQ(barriers(sampled, written).size(), all);
  // A write from before may be visible to the first read only.
  dermis_image_state other = sampled;
  other.stages = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  EXPECT_EQ(barriers(sampled, other).size(), all);
  EXPECT_EQ(barriers(written, written).size(), all);
}

TEST_F(UnusedSlots, StateWithoutStages_HasNoBarrier) {
  constexpr dermis_image_state none{VK_IMAGE_LAYOUT_GENERAL, 0, 0, 0, 0};
  EXPECT_EQ(barriers(none, sampled).size(), 0u);
  EXPECT_EQ(barriers(written, none).size(), 0u);
}

TEST_F(UnusedSlots, MayShareAnImageInAnyLayout) {
  const std::set<VkImage> unused = unused_images();
  const auto slots = list_of(dermis_slot DERMIS_SLOT_INIT, dermis_graph_slots, host.graph);
  std::vector<dermis_image_binding*> sharing;
  for (dermis_image_binding& binding : host.bindings())
    for (const dermis_slot& slot : slots)
      if (slot.id == binding.slot && slot.written == 0 &&
          (unused.contains(binding.image) ||
           slot.best_layout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL))
        sharing.push_back(&binding);
  ASSERT_GT(sharing.size(), unused.size());
  dermis_image_state read = sampled;
  read.layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  uint64_t frame = host.last_frame;
  for (dermis_image_binding* binding : sharing)
    binding->before = binding->after = read;
  for (dermis_image_binding* binding : sharing) {
    if (!unused.contains(binding->image)) continue;
    const VkImage own = std::exchange(binding->image, sharing.front()->image);
    if (own == binding->image) binding->image = sharing.back()->image;
    EXPECT_OK(host.record(dermis_graph_view(host.graph), ++frame));
    binding->image = own;
  }
}

} // namespace
} // namespace dermis::abi_test
