// A host that records all commands itself gets equal pictures from a frame as data.

#include "tests/integration/embedding/cameras.hpp"

#include <set>

namespace dermis::abi_test {
namespace {

void play_dispatch(const VolkDeviceTable& vk, VkCommandBuffer into, const dermis_command& command) {
  vk.vkCmdBindPipeline(into, VK_PIPELINE_BIND_POINT_COMPUTE, command.pipeline);
  vk.vkCmdBindDescriptorSets(into, VK_PIPELINE_BIND_POINT_COMPUTE, command.layout, 0,
                             command.set_count, command.sets, 0, nullptr);
  vk.vkCmdPushConstants(into, command.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, command.push_bytes,
                        command.push_constants);
  if (command.type == DERMIS_COMMAND_DISPATCH)
    vk.vkCmdDispatch(into, command.groups[0], command.groups[1], command.groups[2]);
  else
    vk.vkCmdDispatchIndirect(into, command.buffer, command.offset);
}

void play(const VolkDeviceTable& vk, VkCommandBuffer into, const dermis_command& command,
          const std::function<void(const dermis_pass_call&)>& pass) {
  switch (command.type) {
  case DERMIS_COMMAND_BARRIER:
    return vk.vkCmdPipelineBarrier2(into, command.dependency);
  case DERMIS_COMMAND_DISPATCH:
  case DERMIS_COMMAND_DISPATCH_INDIRECT:
    return play_dispatch(vk, into, command);
  case DERMIS_COMMAND_FILL_BUFFER:
    return vk.vkCmdFillBuffer(into, command.buffer, command.offset, command.bytes, command.value);
  case DERMIS_COMMAND_CLEAR_IMAGE:
    return vk.vkCmdClearColorImage(into, command.image, command.image_layout, &command.color,
                                   command.count, command.ranges);
  case DERMIS_COMMAND_COPY_BUFFER:
    return vk.vkCmdCopyBuffer(into, command.buffer, command.to_buffer, command.count,
                              command.buffer_copies);
  case DERMIS_COMMAND_COPY_IMAGE:
    return vk.vkCmdCopyImage(into, command.image, command.image_layout, command.to_image,
                             command.to_layout, command.count, command.image_copies);
  case DERMIS_COMMAND_RESET_QUERIES:
    return vk.vkCmdResetQueryPool(into, command.query_pool, command.query, command.count);
  case DERMIS_COMMAND_WRITE_TIMESTAMP:
    return vk.vkCmdWriteTimestamp2(into, command.stages, command.query_pool, command.query);
  case DERMIS_COMMAND_HOST_PASS:
    return pass(*command.call);
  case DERMIS_COMMAND_TYPE_FORCE_32BIT:
    break;
  }
  ADD_FAILURE() << "a command of type " << command.type;
}

struct Commands : CameraTest {
  std::set<dermis_command_type> seen;
  std::set<std::string> passes;
  uint64_t submitted = 0;
  bool as_data = false;
  std::vector<dermis_pass_call> host_calls;

  void record(dermis_graph graph, dermis_view view, dermis_frame frame, VkCommandBuffer into) {
    if (!as_data) {
      frame.command_buffer = into;
      const dermis_result result = view != nullptr
                                       ? dermis_view_record(view, &frame)
                                       : dermis_view_record(dermis_graph_view(graph), &frame);
      ASSERT_OK(result);
      return;
    }
    uint32_t count = 0;
    const dermis_command* list = nullptr;
    const dermis_result result =
        view != nullptr ? dermis_view_commands(view, &frame, &count, &list)
                        : dermis_view_commands(dermis_graph_view(graph), &frame, &count, &list);
    ASSERT_OK(result);
    ASSERT_GT(count, 0u);
    for (uint32_t i = 0; i < count; ++i) {
      ASSERT_EQ(list[i].struct_size, sizeof(dermis_command));
      seen.insert(list[i].type);
      passes.insert(list[i].pass);
      play(host->vk, into, list[i],
           [&](const dermis_pass_call& call) { host_calls.push_back(call); });
    }
  }

  // Runs two views of `options` for eight frames with a reload, a resize and changing choices;
  // returns the light of both.
  std::vector<std::vector<float>> run(const GraphOptions& options) {
    const dermis_graph graph = make_graph(options);
    if (graph == nullptr) return {};
    dermis_view view = view_of(graph);
    const Camera first = make_camera(graph, 1), second = make_camera(graph, 2);
    const std::string text =
        options.text.empty() ? read_text("configs/graphs/burley.json") : options.text;
    wait();
    for (uint64_t index = 1; index <= 8; ++index) {
      if (index == 3) {
        EXPECT_OK(reload_text(graph, source_of(text, "graph.json")));
      }
      if (index == 5) {
        EXPECT_OK(dermis_graph_resize(graph, side - 7, side - 1, nullptr));
      }
      dermis_budget budget = DERMIS_BUDGET_INIT;
      budget.flags = DERMIS_BUDGET_DETERMINISTIC;
      budget.milliseconds = index >= 7 ? 0.001f : 0; // The cheapest configuration.
      EXPECT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
      submit(++submitted, [&](VkCommandBuffer into) {
        record(graph, nullptr, frame_of(first, index), into);
        record(graph, view, frame_of(second, index), into);
      });
    }
    return {light_of(first), light_of(second)};
  }
  void expect_the_same(const GraphOptions& options) {
    as_data = false;
    const auto recorded = run(options);
    as_data = true;
    const auto played = run(options);
    ASSERT_EQ(recorded.size(), 2u);
    EXPECT_TRUE(recorded == played);
    EXPECT_FALSE(recorded[0] == recorded[1]);
  }
};

TEST_F(Commands, GraphWithHistory_PlaysBackAsRecorded) {
  expect_the_same(accumulating());
  EXPECT_TRUE(passes.contains("accumulate"));
  EXPECT_TRUE(passes.contains("")) << "barriers between the passes";
  for (const dermis_command_type type :
       {DERMIS_COMMAND_BARRIER, DERMIS_COMMAND_DISPATCH, DERMIS_COMMAND_DISPATCH_INDIRECT,
        DERMIS_COMMAND_FILL_BUFFER, DERMIS_COMMAND_CLEAR_IMAGE, DERMIS_COMMAND_COPY_IMAGE,
        DERMIS_COMMAND_RESET_QUERIES, DERMIS_COMMAND_WRITE_TIMESTAMP})
    EXPECT_TRUE(seen.contains(type)) << type;
}

TEST_F(Commands, AlternatingPlans_GiveEqualPictures) {
  GraphOptions options = accumulating();
  options.text = read_text("configs/graphs/skin.json");
  expect_the_same(options);
}

TEST_F(Commands, CanBeDiscardedLikeAFrame) {
  const dermis_graph graph = make_accumulating();
  const Camera camera = make_camera(graph, 1);
  const dermis_frame frame = frame_of(camera, 1);
  uint32_t count = 0;
  const dermis_command* list = nullptr;
  ASSERT_OK(dermis_view_commands(dermis_graph_view(graph), &frame, &count, &list));
  EXPECT_EQ(dermis_view_commands(dermis_graph_view(graph), &frame, &count, &list),
            DERMIS_ERROR_ARGUMENT)
      << "it counts as recorded";
  EXPECT_EQ(count, 0u);
  EXPECT_EQ(list, nullptr);
  ASSERT_OK(dermis_view_discard(dermis_graph_view(graph), 1));
  ASSERT_OK(dermis_view_commands(dermis_graph_view(graph), &frame, &count, &list));
  ASSERT_OK(dermis_view_discard(dermis_graph_view(graph), 1));
}

void DERMIS_CALL never(void*, const dermis_pass_call*) {
  ADD_FAILURE() << "the host records its passes itself";
}

TEST_F(Commands, NameTheHostPassesToRecord) {
  const dermis_port ports[] = {port_of("light"), port_of("out", DERMIS_PORT_STORAGE_IMAGE_WRITE)};
  const dermis_pass_setting level = real_setting("level", 1, 0.25);
  dermis_pass_type type = pass_type_of("test.tone", ports, never);
  type.settings = &level;
  type.setting_count = 1;
  ASSERT_OK(dermis_register_pass_type(context, &type));
  GraphOptions options = own_graph(R"({ "dermis": 2, "name": "toned",
    "imports": { "lighting": { "format": "rgba16f", "size": "view" } },
    "resources": { "toned": { "format": "rgba16f", "size": "view" } },
    "passes": [ { "pass": "tone", "type": "test.tone", "read": { "light": "lighting" }, "write": { "out": "toned" } } ],
    "exports": ["toned"] })");
  options.width = options.height = side;
  const dermis_graph graph = make_bound_graph(options);
  dermis_frame frame = bound_frame(graph, side, side);
  uint32_t count = 0;
  const dermis_command* list = nullptr;
  ASSERT_OK(dermis_view_commands(dermis_graph_view(graph), &frame, &count, &list));
  uint32_t calls = 0;
  for (uint32_t i = 0; i < count; ++i)
    if (list[i].type == DERMIS_COMMAND_HOST_PASS) {
      ++calls;
      const dermis_pass_call& call = *list[i].call;
      EXPECT_STREQ(call.pass, "tone");
      EXPECT_STREQ(list[i].pass, "tone");
      EXPECT_EQ(call.command_buffer, nullptr);
      ASSERT_EQ(call.port_count, 2u);
      EXPECT_NE(call.ports[0].image, nullptr);
      EXPECT_NE(call.ports[1].view, nullptr);
      ASSERT_EQ(call.setting_count, 1u);
      EXPECT_EQ(call.settings[0], 0.25);
      EXPECT_EQ(call.frame_index, frame.frame_index);
    }
  EXPECT_EQ(calls, 1u);
  ASSERT_OK(dermis_view_discard(dermis_graph_view(graph), frame.frame_index));
}

} // namespace
} // namespace dermis::abi_test
