// Tests buffers and acceleration structures that a host binds: the recorded commands, and the
// errors for wrong bindings.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <iterator>

namespace dermis::abi_test {
namespace {

constexpr const char* traced = R"({ "dermis": 2, "name": "traced",
  "imports": { "scene": { "acceleration_structure": "top_level" },
               "vertices": { "buffer": { "stride": 32, "count": 3 } },
               "light": { "format": "rgba16f", "size": "view" } },
  "resources": { "out": { "format": "rgba16f", "size": "view" } },
  "passes": [ { "pass": "trace", "type": "studio.trace",
                "read": { "scene": "scene", "vertices": "vertices", "light": "light" }, "write": { "out": "out" } } ],
  "exports": ["out"] })";

template <class Handle> Handle handle(uint64_t number) { // The null device never reads the handle.
  Handle out = VK_NULL_HANDLE;
  static_assert(sizeof out == sizeof number);
  std::memcpy(&out, &number, sizeof out);
  return out;
}

struct SeenPorts {
  std::vector<dermis_pass_port> ports;
};

void DERMIS_CALL keep_ports(void* user, const dermis_pass_call* call) {
  auto& seen = *static_cast<SeenPorts*>(user);
  seen.ports.assign(call->ports, call->ports + call->port_count);
}

struct SceneBindings : ::testing::Test {
  NullHost host;
  SeenPorts seen;
  std::vector<dermis_image_binding> images;
  dermis_buffer_binding vertices = DERMIS_BUFFER_BINDING_INIT;
  dermis_acceleration_structure_binding scene = DERMIS_ACCELERATION_STRUCTURE_BINDING_INIT;

  void SetUp() override {
    ASSERT_OK(host.make_context(host.context_desc()));
    const dermis_port ports[] = {port_of("scene", DERMIS_PORT_ACCELERATION_STRUCTURE),
                                 port_of("vertices", DERMIS_PORT_STORAGE_BUFFER_READ),
                                 port_of("light"), port_of("out", DERMIS_PORT_STORAGE_IMAGE_WRITE)};
    const dermis_pass_type type = pass_type_of("studio.trace", ports, keep_ports, &seen);
    ASSERT_OK(dermis_register_pass_type(host.context, &type));
    const std::string text = traced;
    dermis_graph_desc desc = graph_desc(text, "traced.json", 64);
    // Without a profile nothing is scattered.
    dermis_profile profile = skin_profile();
    desc.profiles = &profile;
    desc.profile_count = 1;
    ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
    for (const dermis_slot& slot : slots_of(host.graph)) {
      if (slot.type == DERMIS_SLOT_BUFFER) vertices.slot = slot.id;
      if (slot.type == DERMIS_SLOT_ACCELERATION_STRUCTURE) scene.slot = slot.id;
      if (slot.type == DERMIS_SLOT_IMAGE) images.push_back(host.image_for(slot));
    }
    vertices.buffer = handle<VkBuffer>(0x51);
    vertices.offset = 256;
    vertices.bytes = 320;
    vertices.before = {VK_IMAGE_LAYOUT_UNDEFINED, 0, VK_PIPELINE_STAGE_2_COPY_BIT,
                       VK_ACCESS_2_TRANSFER_WRITE_BIT, 0};
    vertices.after = {VK_IMAGE_LAYOUT_UNDEFINED, 0, VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT,
                      VK_ACCESS_2_SHADER_STORAGE_READ_BIT, 0};
    scene.structure = handle<VkAccelerationStructureKHR>(0x52);
    scene.before = {VK_IMAGE_LAYOUT_UNDEFINED, 0,
                    VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                    VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR, 0};
    scene.after = scene.before;
  }

  dermis_frame frame() const {
    dermis_frame next = DERMIS_FRAME_INIT;
    next.command_buffer = host.device.command_buffer();
    next.frame_index = 1;
    next.clip_from_view[0] = next.clip_from_view[15] = 1.0f; // Orthographic.
    next.clip_from_view[5] = next.clip_from_view[10] = -1.0f;
    next.bindings = images.data();
    next.binding_count = static_cast<uint32_t>(images.size());
    next.buffers = &vertices;
    next.buffer_count = 1;
    next.structures = &scene;
    next.structure_count = 1;
    return next;
  }
};

TEST_F(SceneBindings, SlotsReportTypeStrideAndMinimumBytes) {
  const std::vector<dermis_slot> slots = slots_of(host.graph);
  ASSERT_EQ(slots.size(), 4u);
  EXPECT_EQ(slots[0].type, DERMIS_SLOT_ACCELERATION_STRUCTURE);
  EXPECT_EQ(slots[1].type, DERMIS_SLOT_BUFFER);
  EXPECT_EQ(slots[1].stride, 32u);
  EXPECT_EQ(slots[1].bytes, 96u);
  EXPECT_EQ(slots[1].usage, uint32_t{VK_BUFFER_USAGE_STORAGE_BUFFER_BIT});
  EXPECT_EQ(slots[2].type, DERMIS_SLOT_IMAGE);
}

TEST_F(SceneBindings, AreAcquiredAndReleasedByBarriers) {
  const dermis_frame next = frame();
  uint32_t count = 0;
  const dermis_command* commands = nullptr;
  ASSERT_OK(dermis_view_commands(dermis_graph_view(host.graph), &next, &count, &commands));
  std::vector<VkMemoryBarrier2> memory;
  std::vector<VkBufferMemoryBarrier2> buffers;
  const dermis_pass_call* call = nullptr;
  for (uint32_t i = 0; i < count; ++i) {
    if (commands[i].type == DERMIS_COMMAND_HOST_PASS) call = commands[i].call;
    if (commands[i].type != DERMIS_COMMAND_BARRIER) continue;
    const VkDependencyInfo& one = *commands[i].dependency;
    std::copy_if(one.pMemoryBarriers, one.pMemoryBarriers + one.memoryBarrierCount,
                 std::back_inserter(memory),
                 [](const VkMemoryBarrier2& barrier) { // Excludes the buffer of the counters.
                   return barrier.dstStageMask != VK_PIPELINE_STAGE_2_HOST_BIT;
                 });
    buffers.insert(buffers.end(), one.pBufferMemoryBarriers,
                   one.pBufferMemoryBarriers + one.bufferMemoryBarrierCount);
  }
  // Reads make nothing available, so the release to the host only orders stages.
  ASSERT_EQ(memory.size(), 2u);
  EXPECT_EQ(memory[0].srcStageMask, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR);
  EXPECT_EQ(memory[0].srcAccessMask, VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR);
  EXPECT_EQ(memory[0].dstStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_EQ(memory[0].dstAccessMask, VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR);
  EXPECT_EQ(memory[1].srcStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_EQ(memory[1].dstStageMask, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR);
  ASSERT_EQ(buffers.size(), 2u);
  EXPECT_EQ(buffers[0].buffer, vertices.buffer);
  EXPECT_EQ(buffers[0].offset, 256u);
  EXPECT_EQ(buffers[0].size, 320u);
  EXPECT_EQ(buffers[0].srcAccessMask, VK_ACCESS_2_TRANSFER_WRITE_BIT);
  EXPECT_EQ(buffers[0].dstAccessMask, VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
  EXPECT_EQ(buffers[1].dstStageMask, VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT);
  ASSERT_NE(call, nullptr);
  EXPECT_EQ(call->ports[0].structure, scene.structure);
  EXPECT_EQ(call->ports[1].buffer, vertices.buffer);
  EXPECT_EQ(call->ports[1].offset, 256u);
  EXPECT_EQ(call->ports[1].bytes, 320u);
  EXPECT_NE(call->ports[2].image, nullptr);
  EXPECT_EQ(call->ports[2].structure, nullptr);
}

TEST_F(SceneBindings, WrongBindings_AreRejectedByName) {
  struct Wrong {
    const char* says;
    std::function<void(SceneBindings&, dermis_frame&)> change;
  };
  const Wrong all[] = {
      {"nothing is bound to 'vertices'", [](auto&, auto& f) { f.buffer_count = 0; }},
      {"nothing is bound to 'scene'", [](auto&, auto& f) { f.structure_count = 0; }},
      {"buffers is NULL and its count is 1", [](auto&, auto& f) { f.buffers = nullptr; }},
      {"buffers[0].buffer ('vertices') is null",
       [](auto& t, auto&) { t.vertices.buffer = VK_NULL_HANDLE; }},
      {"buffers[0].bytes ('vertices') is 64, the graph needs at least 96",
       [](auto& t, auto&) { t.vertices.bytes = 64; }},
      {"is 100, no multiple of the 32 bytes of an element",
       [](auto& t, auto&) { t.vertices.bytes = 100; }},
      {"buffers[0].offset ('vertices') is 1, expected a multiple",
       [](auto& t, auto&) { t.vertices.offset = 1; }},
      {"binds a buffer to slot 0 ('scene'), which takes an acceleration structure",
       [](auto& t, auto&) { t.vertices.slot = t.scene.slot; }},
      {"binds an acceleration structure to slot 2 ('light'), which takes an image",
       [](auto& t, auto&) { t.scene.slot = 2; }},
      {"binds an image to slot 1 ('vertices'), which takes a buffer",
       [](auto& t, auto&) { t.images[0].slot = t.vertices.slot; }},
      {"structures[0].structure ('scene') is null",
       [](auto& t, auto&) { t.scene.structure = VK_NULL_HANDLE; }},
      {"structures[0].slot is 9, the graph has slots 0..3",
       [](auto& t, auto&) { t.scene.slot = 9; }},
      {"structures[0].before.layout ('scene') is 1, expected UNDEFINED",
       [](auto& t, auto&) { t.scene.before.layout = VK_IMAGE_LAYOUT_GENERAL; }},
      {"structures[0].after ('scene'): transfer is 1, expected 0",
       [](auto& t, auto&) { t.scene.after.transfer = 1; }},
      {"buffers[0].before ('vertices'): queue_family is 7 and transfer 0",
       [](auto& t, auto&) { t.vertices.before.queue_family = 7; }},
      {"buffers[0].before ('vertices') has access 0x1000 but no stages",
       [](auto& t, auto&) { t.vertices.before.stages = 0; }},
      {"buffers[0].struct_size is 12", [](auto& t, auto&) { t.vertices.struct_size = 12; }},
  };
  for (const Wrong& wrong : all) {
    const auto kept_images = images;
    const auto kept_vertices = vertices;
    const auto kept_scene = scene;
    dermis_frame next = frame();
    wrong.change(*this, next);
    EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &next),
                Fails(DERMIS_ERROR_ARGUMENT, wrong.says))
        << wrong.says;
    images = kept_images;
    vertices = kept_vertices;
    scene = kept_scene;
  }
  const dermis_frame next = frame();
  EXPECT_OK(dermis_view_record(dermis_graph_view(host.graph), &next)) << "nothing has changed: ";
}

TEST_F(SceneBindings, RayQueryFlag_NeedsADeviceWithRayQueries) {
  dermis_context_desc desc = host.context_desc();
  desc.flags |= DERMIS_CONTEXT_RAY_QUERY;
  dermis_context other = nullptr;
  EXPECT_THAT(
      dermis_context_create(&desc, &other),
      Fails(DERMIS_ERROR_UNSUPPORTED, "rayQuery", VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME));
}

} // namespace
} // namespace dermis::abi_test
