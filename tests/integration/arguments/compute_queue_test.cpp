// A queue family with compute and without graphics records every frame, including the frame after a
// resize.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

namespace dermis::abi_test {
namespace {

// Stages that a family with compute and transfer supports (Vulkan 1.3, table "Supported pipeline
// stage flags").
constexpr VkPipelineStageFlags2 compute_stages =
    VK_PIPELINE_STAGE_2_TOP_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT |
    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT |
    VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_CLEAR_BIT |
    VK_PIPELINE_STAGE_2_BOTTOM_OF_PIPE_BIT | VK_PIPELINE_STAGE_2_HOST_BIT |
    VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;

void expect_compute_stages(const VkDependencyInfo& info) {
  for (uint32_t i = 0; i < info.memoryBarrierCount; ++i)
    EXPECT_EQ((info.pMemoryBarriers[i].srcStageMask | info.pMemoryBarriers[i].dstStageMask) &
                  ~compute_stages,
              0u);
  for (uint32_t i = 0; i < info.imageMemoryBarrierCount; ++i)
    EXPECT_EQ(
        (info.pImageMemoryBarriers[i].srcStageMask | info.pImageMemoryBarriers[i].dstStageMask) &
            ~compute_stages,
        0u);
}

struct FrameCommands {
  uint32_t dispatches = 0, image_copies = 0;
};

class ComputeQueue : public ::testing::Test {
protected:
  FrameCommands record(uint64_t index) {
    const dermis_frame frame = host.frame_at(index);
    uint32_t count = 0;
    const dermis_command* commands = nullptr;
    EXPECT_OK(dermis_view_commands(dermis_graph_view(host.graph), &frame, &count, &commands));
    FrameCommands found;
    for (uint32_t i = 0; i < count; ++i) {
      found.dispatches += commands[i].type == DERMIS_COMMAND_DISPATCH ? 1 : 0;
      found.image_copies += commands[i].type == DERMIS_COMMAND_COPY_IMAGE ? 1 : 0;
      if (commands[i].type == DERMIS_COMMAND_BARRIER)
        expect_compute_stages(*commands[i].dependency);
    }
    return found;
  }

  NullHost host;
};

TEST_F(ComputeQueue, RescalesHistoriesByDispatches) {
  host.device.set_queue_flags(VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT);
  ASSERT_OK(host.make_context(host.context_desc()));
  const std::string text = read_text("configs/graphs/papers/sap_residual.json");
  dermis_profile profile = skin_profile();
  dermis_slot_format depth = slot_format("depth", VK_FORMAT_D32_SFLOAT);
  dermis_graph_desc desc = graph_desc(text, "sap_residual.json", 64);
  desc.profiles = &profile;
  desc.formats = &depth;
  desc.profile_count = desc.format_count = 1;
  ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
  host.make_bindings();
  record(1);
  const FrameCommands usual = record(2);
  ASSERT_OK(dermis_graph_resize(host.graph, 96, 48, nullptr));
  host.make_bindings();
  const FrameCommands resized = record(3), after = record(4);
  EXPECT_GT(resized.dispatches, usual.dispatches) << "histories are rescaled";
  EXPECT_EQ(resized.image_copies, 0u);
  EXPECT_EQ(after.dispatches, usual.dispatches) << "only once";
}

} // namespace
} // namespace dermis::abi_test
