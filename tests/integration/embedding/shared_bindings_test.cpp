// Tests one buffer, acceleration structure or image of the host at two slots of a frame: ranges,
// aspects and states.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <cstring>
#include <map>

namespace dermis::abi_test {
namespace {

constexpr const char* shared_graph = R"({ "dermis": 2, "name": "shared",
  "imports": { "first": { "buffer": { "stride": 16, "count": [4, 1] } },
               "second": { "buffer": { "stride": 16, "count": [4, 1] } },
               "changed": { "buffer": { "stride": 16, "count": [4, 1] } },
               "scene": { "acceleration_structure": "top_level" },
               "shadows": { "acceleration_structure": "top_level" },
               "depth": { "format": "depth", "size": "view" },
               "marks": { "format": "r8_uint", "size": "view" } },
  "resources": { "out": { "format": "rgba16f", "size": "view" } },
  "passes": [ { "pass": "read", "type": "studio.read_all",
                "read": { "first": "first", "second": "second", "scene": "scene", "shadows": "shadows",
                          "depth": "depth", "marks": "marks" },
                "write": { "out": "out", "changed": "changed" } } ],
  "exports": ["out"] })";

template <class Handle> Handle null_handle(uint64_t number) {
  Handle out = VK_NULL_HANDLE;
  static_assert(sizeof out == sizeof number);
  std::memcpy(&out, &number, sizeof out);
  return out;
}

void DERMIS_CALL ignore(void*, const dermis_pass_call*) {}

struct SharedBindings : ::testing::Test {
  NullHost host;
  std::vector<dermis_image_binding> images;
  std::vector<dermis_buffer_binding> buffers;
  std::vector<dermis_acceleration_structure_binding> structures;
  std::map<std::string, size_t> place; // Index in one of the three lists.
  uint64_t frame_index = 0;

  void add_pass_type() {
    const dermis_port ports[] = {port_of("first", DERMIS_PORT_STORAGE_BUFFER_READ),
                                 port_of("second", DERMIS_PORT_STORAGE_BUFFER_READ),
                                 port_of("scene", DERMIS_PORT_ACCELERATION_STRUCTURE),
                                 port_of("shadows", DERMIS_PORT_ACCELERATION_STRUCTURE),
                                 port_of("depth"),
                                 port_of("marks"),
                                 port_of("out", DERMIS_PORT_STORAGE_IMAGE_WRITE),
                                 port_of("changed", DERMIS_PORT_STORAGE_BUFFER_UPDATE)};
    const dermis_pass_type type = pass_type_of("studio.read_all", ports, ignore);
    ASSERT_OK(dermis_register_pass_type(host.context, &type));
  }

  void bind_all() {
    uint64_t number = 0x50;
    for (const dermis_slot& slot : slots_of(host.graph)) {
      if (slot.type == DERMIS_SLOT_IMAGE) {
        place[slot.name] = images.size();
        images.push_back(host.image_for(slot));
      } else if (slot.type == DERMIS_SLOT_BUFFER) {
        place[slot.name] = buffers.size();
        dermis_buffer_binding& one =
            buffers.emplace_back(dermis_buffer_binding DERMIS_BUFFER_BINDING_INIT);
        one.slot = slot.id;
        one.buffer = null_handle<VkBuffer>(++number);
        one.bytes = 64;
        one.before = {VK_IMAGE_LAYOUT_UNDEFINED, 0, VK_PIPELINE_STAGE_2_COPY_BIT,
                      VK_ACCESS_2_TRANSFER_WRITE_BIT, 0};
        one.after = one.before;
      } else {
        place[slot.name] = structures.size();
        auto& one = structures.emplace_back(
            dermis_acceleration_structure_binding DERMIS_ACCELERATION_STRUCTURE_BINDING_INIT);
        one.slot = slot.id;
        one.structure = null_handle<VkAccelerationStructureKHR>(++number);
        one.before = {VK_IMAGE_LAYOUT_UNDEFINED, 0,
                      VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                      VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR, 0};
        one.after = one.before;
      }
    }
  }

  void SetUp() override {
    ASSERT_OK(host.make_context(host.context_desc()));
    add_pass_type();
    const std::string text = shared_graph;
    dermis_slot_format depth = slot_format("depth", VK_FORMAT_D32_SFLOAT_S8_UINT);
    dermis_graph_desc desc = graph_desc(text, "shared.json", 64);
    desc.formats = &depth;
    desc.format_count = 1;
    ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
    bind_all();
  }

  dermis_result record() {
    dermis_frame next = DERMIS_FRAME_INIT;
    next.command_buffer = host.device.command_buffer();
    next.frame_index = frame_index + 1;
    next.completed_frame_index = frame_index;
    next.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
    next.clip_from_view[0] = next.clip_from_view[15] = 1.0f;
    next.clip_from_view[5] = next.clip_from_view[10] = -1.0f;
    next.bindings = images.data();
    next.binding_count = static_cast<uint32_t>(images.size());
    next.buffers = buffers.data();
    next.buffer_count = static_cast<uint32_t>(buffers.size());
    next.structures = structures.data();
    next.structure_count = static_cast<uint32_t>(structures.size());
    const dermis_result result = dermis_view_record(dermis_graph_view(host.graph), &next);
    if (result == DERMIS_OK) ++frame_index;
    return result;
  }
  void recorded() { EXPECT_EQ(record(), DERMIS_OK) << dermis_last_error(); }
  void rejected(const char* a, const char* b) {
    EXPECT_THAT(record(), Fails(DERMIS_ERROR_ARGUMENT, a, b, "bound to the same"));
  }
  dermis_buffer_binding& buffer(const char* name) { return buffers[place.at(name)]; }
  dermis_acceleration_structure_binding& structure(const char* name) {
    return structures[place.at(name)];
  }
  dermis_image_binding& image(const char* name) { return images[place.at(name)]; }
};

TEST_F(SharedBindings, ReadOnlyBuffer_MayHaveTwoSlots) {
  buffer("second").buffer = buffer("first").buffer;
  recorded();
  buffer("second").before.stages = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  rejected("'first'", "'second'");
}

TEST_F(SharedBindings, WrittenBuffer_HasOneSlotPerRange) {
  buffer("changed").buffer = buffer("first").buffer;
  rejected("'first'", "'changed'");
  buffer("changed").offset = 256; // After the 64 bytes of `first`.
  recorded();
  buffer("first").bytes = 320;
  rejected("'first'", "'changed'");
}

TEST_F(SharedBindings, AccelerationStructure_EqualStates_MayHaveTwoSlots) {
  structure("shadows").structure = structure("scene").structure;
  recorded();
  structure("shadows").after.access = VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR;
  rejected("'scene'", "'shadows'");
}

} // namespace
} // namespace dermis::abi_test
