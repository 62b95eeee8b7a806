// Tests frames that cannot be recorded: the message names the field, the graph is unchanged, and
// the corrected frame can be recorded.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/recorded_frame.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace dermis::abi_test {
namespace {

constexpr float nan_value = NAN;

struct Frames : RecordedFrame {};

using Bindings = std::vector<dermis_image_binding>;
using Change = std::function<void(dermis_frame&, Bindings&)>;

TEST_F(Frames, WrongField_IsNamed) {
  const std::pair<std::string, Change> changes[] = {
      {"command_buffer is NULL", [](auto& f, auto&) { f.command_buffer = nullptr; }},
      {"struct_size", [](auto& f, auto&) { f.struct_size = 12; }},
      {"flags is 0x8", [](auto& f, auto&) { f.flags = 8; }},
      {"flags", [](auto& f, auto&) { f.flags = 0x100; }},
      {"frame_index is 1", [](auto& f, auto&) { f.frame_index = 1; }},
      {"frame_index", [](auto& f, auto&) { f.frame_index = f.completed_frame_index = 0; }},
      {"less than frame_index", [](auto& f, auto&) { f.completed_frame_index = 2; }},
      {"with 2 frames in flight", [](auto& f, auto&) { f.frame_index = 4; }},
      {"delta_seconds", [](auto& f, auto&) { f.delta_seconds = nan_value; }},
      {"delta_seconds", [](auto& f, auto&) { f.delta_seconds = -1; }},
      {"metres_per_unit", [](auto& f, auto&) { f.metres_per_unit = INFINITY; }},
      {"metres_per_unit", [](auto& f, auto&) { f.metres_per_unit = -1; }},
      {"exposure", [](auto& f, auto&) { f.exposure = nan_value; }},
      {"exposure", [](auto& f, auto&) { f.exposure = -2; }},
      {"jitter", [](auto& f, auto&) { f.jitter_x = nan_value; }},
      {"jitter", [](auto& f, auto&) { f.jitter_y = INFINITY; }},
      {"depth_kind", [](auto& f, auto&) { f.depth_kind = static_cast<dermis_depth_kind>(2); }},
      {"depth_kind is -1",
       [](auto& f, auto&) { f.depth_kind = static_cast<dermis_depth_kind>(-1); }},
      {"clip_from_view",
       [](auto& f, auto&) { std::fill(f.clip_from_view, f.clip_from_view + 16, 0.0f); }},
      {"clip_from_view", [](auto& f, auto&) { f.clip_from_view[0] = nan_value; }},
      {"a matrix has an element", [](auto& f, auto&) { f.view_from_world[3] = nan_value; }},
      {"a matrix has an element", [](auto& f, auto&) { f.view_from_world[15] = nan_value; }},
      {"a matrix has an element", [](auto& f, auto&) { f.previous_clip_from_view[0] = nan_value; }},
      {"a matrix has an element", [](auto& f, auto&) { f.previous_view_from_world[7] = INFINITY; }},
      {"rect_width is 0", [](auto& f, auto&) { f.rect_x = 1; }},
      {"rect_width is 0", [](auto& f, auto&) { f.rect_y = 1; }},
      {"rect_width is 0", [](auto& f, auto&) { f.rect_height = 1; }},
      {"is not inside the allocated size 64x64",
       [](auto& f, auto&) {
         f.rect_width = 1;
         f.rect_height = 65;
       }},
      {"rectangle",
       [](auto& f, auto&) {
         f.rect_width = 65;
         f.rect_height = 1;
       }},
      {"rectangle", [](auto& f, auto&) { f.rect_width = 64; }},
      {"rectangle",
       [](auto& f, auto&) {
         f.rect_width = f.rect_height = 1;
         f.rect_x = 0xffffffffu;
       }},
      {"bounds are given", [](auto& f, auto&) { f.bounds_x = 1; }},
      {"bounds are given", [](auto& f, auto&) { f.bounds_y = 1; }},
      {"bounds are given", [](auto& f, auto&) { f.bounds_width = 1; }},
      {"bounds are given", [](auto& f, auto&) { f.bounds_height = 1; }},
      {"as in bindings[0]", [](auto&, auto& b) { b[1].struct_size = 0; }},
      {"bindings[0].struct_size is 8, expected " +
           std::to_string(sizeof(dermis_image_binding)) + "..4096",
       [](auto&, auto& b) { b[0].struct_size = 8; }},
      {"bindings[0].slot is 99", [](auto&, auto& b) { b[0].slot = 99; }},
      {"bindings[0].image", [](auto&, auto& b) { b[0].image = VK_NULL_HANDLE; }},
      {"bindings[0].view",
       [](auto&, auto& b) {
         b[0].view = VK_NULL_HANDLE;
         b[0].content_id = 0;
       }},
      {"r32f", [](auto&, auto& b) { b[0].format = VK_FORMAT_R32_SFLOAT; }},
      {"63x64", [](auto&, auto& b) { b[0].width = 63; }},
      {"before.layout", [](auto&, auto& b) { b[0].before.layout = VK_IMAGE_LAYOUT_UNDEFINED; }},
      {"a format unknown to graphs",
       [](auto&, auto& b) { b[0].format = VK_FORMAT_ASTC_4x4_SRGB_BLOCK; }},
      {"is 64x63, the graph needs at least 64x64", [](auto&, auto& b) { b[0].height = 63; }},
      {"is PREINITIALIZED",
       [](auto&, auto& b) { b[0].after.layout = VK_IMAGE_LAYOUT_PREINITIALIZED; }},
      {"is UNDEFINED, to which",
       [](auto&, auto& b) { b[0].after.layout = VK_IMAGE_LAYOUT_UNDEFINED; }},
      {"before.layout", [](auto&, auto& b) { b[0].before.layout = VK_IMAGE_LAYOUT_MAX_ENUM; }},
      {"after.layout", [](auto&, auto& b) { b[0].after.layout = VK_IMAGE_LAYOUT_MAX_ENUM; }},
      {"but no stages", [](auto&, auto& b) { b[0].after.stages = 0; }},
      {"no stages", [](auto&, auto& b) { b[0].before.stages = 0; }},
      {"queue_family", [](auto&, auto& b) { b[0].after.queue_family = 77; }},
      {"the device has 1 families",
       [](auto&, auto& b) {
         b[0].before.queue_family = 1;
         b[0].before.transfer = 1;
       }},
      {"layer_count 0, which means all layers", [](auto&, auto& b) { b[0].layer = 1; }},
      {"a second time", [](auto&, auto& b) { b[1].slot = b[0].slot; }},
      {"clip_from_view", [](auto& f, auto&) { f.clip_from_view[1] = 1; }},
      {"maps all points to one depth",
       [](auto& f, auto&) {
         f.depth_kind = DERMIS_DEPTH_DEVICE;
         f.clip_from_view[10] = 0; // orthographic
       }},
  };
  const dermis_frame good = host.frame_at(2);
  const uint64_t commands = host.device.commands();
  for (const auto& [said, change] : changes) {
    dermis_frame frame = good;
    Bindings bound(good.bindings, good.bindings + good.binding_count);
    change(frame, bound);
    frame.bindings = bound.data();
    EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
                Fails(DERMIS_ERROR_ARGUMENT, said))
        << said;
  }
  dermis_frame unbound = good;
  unbound.bindings = nullptr;
  EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &unbound),
              Fails(DERMIS_ERROR_ARGUMENT, "bindings is NULL"));
  EXPECT_EQ(dermis_view_record(dermis_graph_view(host.graph), nullptr), DERMIS_ERROR_ARGUMENT);
  EXPECT_EQ(host.device.commands(), commands) << "nothing was recorded";
  EXPECT_OK(host.record());
}

TEST_F(Frames, ColumnMajorMatrix_IsReported) {
  dermis_frame frame = host.frame_at(2);
  const float by_rows[16] = {2, 0, 0, 0, 0, -2, 0, 0, 0, 0, -1, -0.1f, 0, 0, -1, 0};
  for (size_t i = 0; i < 16; ++i)
    frame.clip_from_view[i % 4 * 4 + i / 4] = by_rows[i];
  EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
              Fails(DERMIS_ERROR_ARGUMENT, "it is stored column by column"));
  std::copy(by_rows, by_rows + 16, frame.clip_from_view);
  frame.clip_from_view[1] = 1; // also wrong, in another way
  EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
              Fails(DERMIS_ERROR_ARGUMENT, Not(HasSubstr("column by column"))));
  std::copy(by_rows, by_rows + 16, frame.clip_from_view);
  EXPECT_OK(dermis_view_record(dermis_graph_view(host.graph), &frame));
}

TEST_F(Frames, ContradictingHandedness_IsRejected) {
  const float perspective[16] = {2, 0, 0, 0, 0, -2, 0, 0, 0, 0, -1, -0.1f, 0, 0, -1, 0};
  const float orthographic[16] = {2, 0, 0, 0, 0, -2, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1};
  using Matrix = const float(&)[16];
  const auto frame_of = [&](Matrix now, bool now_left, Matrix before, bool before_left,
                            uint32_t flags) {
    dermis_frame frame = host.frame_at(2);
    for (size_t i = 0; i < 16; ++i) {
      frame.clip_from_view[i] = i % 4 == 2 && now_left ? -now[i] : now[i];
      frame.previous_clip_from_view[i] = i % 4 == 2 && before_left ? -before[i] : before[i];
    }
    frame.flags |= flags;
    return frame;
  };
  const auto rejected = [&](const dermis_frame& frame, const char* said) {
    EXPECT_THAT(dermis_view_record(dermis_graph_view(host.graph), &frame),
                Fails(DERMIS_ERROR_ARGUMENT, said, "DERMIS_FRAME_LEFT_HANDED"))
        << said;
  };
  rejected(frame_of(perspective, false, perspective, false, DERMIS_FRAME_LEFT_HANDED),
           "declared left-handed, but clip_from_view has w = -z");
  rejected(frame_of(perspective, true, perspective, false, 0),
           "previous_clip_from_view has w = -z");
  rejected(frame_of(perspective, false, perspective, true, 0), "previous_clip_from_view has w = z");
  rejected(frame_of(orthographic, false, perspective, true, 0), "the frame is right-handed");
  rejected(frame_of(orthographic, true, perspective, false, DERMIS_FRAME_LEFT_HANDED),
           "the frame is left-handed");
  rejected(frame_of(orthographic, true, orthographic, true, 0), "only points behind the camera");
  rejected(frame_of(orthographic, false, orthographic, false, DERMIS_FRAME_LEFT_HANDED),
           "only points behind the camera");
  const dermis_frame accepted[] = {
      frame_of(perspective, true, perspective, true, 0),
      frame_of(perspective, true, perspective, true, DERMIS_FRAME_LEFT_HANDED),
      frame_of(orthographic, true, perspective, true, DERMIS_FRAME_LEFT_HANDED),
  };
  for (const dermis_frame& frame : accepted) {
    EXPECT_OK(dermis_view_record(dermis_graph_view(host.graph), &frame));
    EXPECT_OK(dermis_view_discard(dermis_graph_view(host.graph), 2));
  }
}

TEST_F(Frames, Discard_WorksOnceAndNotAcrossAReload) {
  const auto rejected = [&](uint64_t index, const char* said) {
    EXPECT_THAT(dermis_view_discard(dermis_graph_view(host.graph), index),
                Fails(DERMIS_ERROR_ARGUMENT, said))
        << said;
  };
  ASSERT_OK(host.record());
  rejected(1, "expected that of the frame recorded last, 2");
  EXPECT_OK(dermis_view_discard(dermis_graph_view(host.graph), 2));
  rejected(1, "no frame can be discarded: none was recorded since");
  // The first frame of a reloaded graph, after the next reload.
  ASSERT_OK(host.reload());
  host.last_frame = 1;
  ASSERT_OK(host.record());
  ASSERT_OK(host.reload());
  rejected(2, "the graph was reloaded or resized since frame 2");
  EXPECT_OK(host.record());
}

// ---- Exceptions of C++ hosts, and the files that hosts open

VkResult DERMIS_CALL take_and_throw(void*, const dermis_memory_request*, dermis_memory_block*) {
  throw 1;
}
void DERMIS_CALL give_back_nothing(void*, const dermis_memory_block*) {}

TEST(ThrowingHosts, ExceptionsBecomeResultCodes) {
  dermis_device_allocator allocator = DERMIS_DEVICE_ALLOCATOR_INIT;
  allocator.allocate = take_and_throw;
  allocator.free = give_back_nothing;
  NullHost host;
  dermis_context_desc desc = host.context_desc();
  desc.device_allocator = &allocator;
  ASSERT_OK(host.make_context(desc));
  EXPECT_THAT(host.make_graph(),
              Fails(DERMIS_ERROR_VULKAN, "the host's allocator failed (VK_ERROR_UNKNOWN"));
  EXPECT_EQ(host.device.alive(), 0u);
}

struct Delivered {
  const char* text = nullptr;
  size_t length = 0;
};
uint32_t DERMIS_CALL deliver(void* user, const char*, dermis_source* source) {
  const Delivered& delivered = *static_cast<Delivered*>(user);
  source->text = delivered.text;
  source->length = delivered.length;
  return 1;
}

TEST(IncludedFiles, Unreadable_AreErrorsOfTheGraph) {
  NullHost host;
  ASSERT_OK(host.make_context(host.context_desc()));
  const std::string text =
      "{ \"dermis\": 2, \"name\": \"a\", \"passes\": [ { \"include\": \"part.json\" } ] }";
  const std::pair<Delivered, const char*> cases[] = {
      {{nullptr, 3}, "the host delivers no text"},
      {{"{}", size_t{1} << 40}, "the host delivers 1099511627776 bytes, at most"},
  };
  for (auto [delivered, said] : cases) {
    dermis_graph_desc desc = graph_desc(text, "a.json", 16);
    desc.include = deliver;
    desc.include_user = &delivered;
    EXPECT_THAT(dermis_graph_create(host.context, &desc, &host.graph, nullptr),
                Fails(DERMIS_ERROR_CONFIG, said));
  }
}

// ---- Pass types of the host

TEST(HostsPassTypes, TooManyPassTypes_AreRejected) {
  NullHost host;
  ASSERT_OK(host.make_context(host.context_desc()));
  dermis_port port = DERMIS_PORT_INIT;
  port.name = "picture";
  dermis_pass_setting setting = DERMIS_PASS_SETTING_INIT;
  setting.name = "on";
  dermis_pass_type type = DERMIS_PASS_TYPE_INIT;
  type.name = "studio.one";
  type.ports = &port;
  type.port_count = 1;
  type.record = [](void*, const dermis_pass_call*) {};
  const auto rejected = [&](const char* said) {
    EXPECT_THAT(dermis_register_pass_type(host.context, &type), Fails(DERMIS_ERROR_ARGUMENT, said))
        << said;
  };
  type.setting_count = 1;
  rejected("type.settings is NULL, setting_count is 1");
  type.settings = &setting;
  setting.type = static_cast<dermis_pass_setting_type>(3);
  rejected("type.settings[0].type is 3, expected 0..2");
  type.setting_count = 33;
  rejected("setting_count 33, at most");
  type.setting_count = 0;
  dermis_result result = DERMIS_OK;
  uint32_t taken = 0;
  for (std::string name; result == DERMIS_OK && taken < 100000;
       taken += result == DERMIS_OK ? 1 : 0) {
    name = "studio.kind" + std::to_string(taken);
    type.name = name.c_str();
    result = dermis_register_pass_type(host.context, &type);
  }
  EXPECT_THAT(result, Fails(DERMIS_ERROR_ARGUMENT,
                            "the context has " + std::to_string(taken) + " pass types already"));
}

TEST_F(Frames, MissingBindings_NameOptionalSlotsAndCure) {
  const std::vector<dermis_slot> slots = slots_of(host.graph);
  const auto number = [&](std::string_view name) {
    for (const dermis_slot& slot : slots)
      if (name == slot.name) return slot.id;
    return UINT32_MAX;
  };
  const auto rejected_without = [&](std::initializer_list<const char*> missing) -> std::string {
    dermis_frame frame = host.frame_at(2);
    Bindings bindings(frame.bindings, frame.bindings + frame.binding_count);
    std::erase_if(bindings, [&](const dermis_image_binding& binding) {
      return std::any_of(missing.begin(), missing.end(),
                         [&](const char* name) { return binding.slot == number(name); });
    });
    frame.bindings = bindings.data();
    frame.binding_count = static_cast<uint32_t>(bindings.size());
    EXPECT_EQ(dermis_view_record(dermis_graph_view(host.graph), &frame), DERMIS_ERROR_ARGUMENT);
    return dermis_last_error();
  };
  const std::string required = rejected_without({"depth"});
  EXPECT_THAT(required,
              HasSubstr("'depth' (slot " + std::to_string(number("depth")) + ", required)"));
  EXPECT_THAT(required, Not(HasSubstr("unbound")));
  const std::string both = rejected_without({"depth", "albedo"});
  EXPECT_THAT(both, HasAll("'depth' (slot " + std::to_string(number("depth")) + ", required)",
                           "'albedo' (slot " + std::to_string(number("albedo")) + ", optional)",
                           "dermis_graph_desc.unbound"));
}

} // namespace
} // namespace dermis::abi_test
