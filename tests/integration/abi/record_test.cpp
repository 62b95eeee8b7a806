// Tests a frame: its effect on the light, and every field that can be wrong.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <cmath>
#include <functional>
#include <limits>

namespace dermis::abi_test {
namespace {

struct Record : DermisTest {};

TEST_F(Record, LightCrossesAnEdgeAndIsConserved) {
  const dermis_graph graph = make_graph();
  ASSERT_OK(dermis_graph_set_setting(graph, "samples", "256", nullptr));
  make_images(graph);
  const auto before = texels("lighting");
  dermis_frame one = bound_frame(graph);
  ASSERT_OK(record(graph, one));
  const auto after = texels("lighting");
  ASSERT_EQ(after.size(), before.size());
  // Returns the mean of a column over its rows, red. Albedo is unbound, so the light is not
  // multiplied.
  const auto column = [&](uint32_t x) {
    double sum = 0;
    for (uint32_t y = 0; y < 64; ++y)
      sum += after[(y * 64 + x) * 4];
    return sum / 64;
  };
  for (const float value : after)
    ASSERT_TRUE(std::isfinite(value));
  EXPECT_GT(column(32), 0.05) << "red light reaches the dark half";
  EXPECT_LT(column(31), 0.95) << "and is missing in the bright half";
  EXPECT_GT(column(31), column(32));
  EXPECT_GT(column(32), column(36));
  // Far from the edge compared with d (two pixels): beyond 30 pixels less than exp(-30/6) of the
  // light is left; fp16 stores add less than 2^-10.
  EXPECT_NEAR(column(2), 1.0, 0.01);
  EXPECT_NEAR(column(61), 0.0, 0.01);
  // Symmetry of the edge: one side gains what the other loses. The noise of 256 samples over 64
  // rows is below 0.5 / sqrt(256 * 64) = 0.004 per column.
  EXPECT_NEAR(column(31) + column(32), 1.0, 0.02);
}

TEST_F(Record, ImagesAreReturnedInTheRequestedState) {
  const dermis_graph graph = make_bound_graph();
  auto bound = bindings(graph);
  for (auto& binding : bound) {
    binding.after = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, 0, VK_PIPELINE_STAGE_2_COPY_BIT,
                     VK_ACCESS_2_TRANSFER_READ_BIT, 0};
  }
  dermis_frame one = frame(bound);
  ASSERT_OK(record(graph, one));
  // The validation layer reports a wrong layout or missing visibility.
  for (const auto& [name, image] : images) {
    const auto read =
        demo::read_image(*host, image,
                         {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                          VK_ACCESS_2_TRANSFER_READ_BIT});
    EXPECT_TRUE(read) << name;
  }
}

TEST_F(Record, ImagesAreReleasedToAndAcquiredFromOutside) {
  const dermis_graph graph = make_bound_graph();
  auto bound = bindings(graph);
  for (auto& binding : bound)
    binding.after.queue_family = binding.before.queue_family = VK_QUEUE_FAMILY_EXTERNAL;
  // The first frame gets the images in their initial state.
  for (const uint32_t acquired : {0u, 1u, 1u}) {
    for (auto& binding : bound) {
      binding.before.transfer = acquired;
      binding.before.queue_family = acquired == 1 ? VK_QUEUE_FAMILY_EXTERNAL : 0;
      binding.after.transfer = 1;
    }
    dermis_frame one = frame(bound);
    ASSERT_OK(record(graph, one));
  }
}

TEST_F(Record, Rectangle_LeavesTheRestUnchanged) {
  const dermis_graph graph = make_bound_graph();
  const auto before = texels("lighting");
  dermis_frame one = bound_frame(graph, 40, 24);
  one.rect_x = 16;
  one.rect_y = 8;
  one.rect_width = 40;
  one.rect_height = 24;
  ASSERT_OK(record(graph, one));
  const auto after = texels("lighting");
  uint32_t changed = 0;
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const size_t at = (size_t{y} * 64 + x) * 4;
      const bool inside = x >= 16 && x < 56 && y >= 8 && y < 32;
      if (inside)
        changed += after[at] != before[at] ? 1 : 0;
      else
        EXPECT_EQ(after[at], before[at]) << x << "," << y;
    }
  EXPECT_GT(changed, 24u * 4u);
}

TEST_F(Record, TimesOfTheNewestCompletedFrameComeInPlanOrder) {
  const dermis_graph graph = make_bound_graph();
  const auto bound = bindings(graph);
  std::array<dermis_pass_timing, 16> times{};
  times[0].struct_size = sizeof times[0];
  uint32_t count = 16;
  EXPECT_EQ(dermis_view_timings(dermis_graph_view(graph), 0, &count, times.data()),
            DERMIS_NOT_READY);
  for (int i = 0; i < 3; ++i) {
    dermis_frame one = frame(bound);
    ASSERT_OK(record(graph, one));
  }
  ASSERT_OK(dermis_view_timings(dermis_graph_view(graph), last_frame, &count, times.data()));
  ASSERT_EQ(count, 5u);
  EXPECT_STREQ(times[0].pass, "classify");
  EXPECT_STREQ(times[4].pass, "combine");
  for (uint32_t i = 0; i < count; ++i) {
    EXPECT_EQ(times[i].frame_index, last_frame);
    EXPECT_GT(times[i].nanoseconds, 0u);
    EXPECT_LT(times[i].nanoseconds, 10'000'000'000u);
  }
  EXPECT_EQ(dermis_view_timings(dermis_graph_view(graph), last_frame + 1, &count, times.data()),
            DERMIS_ERROR_ARGUMENT);
}

TEST_F(Record, EveryMissingSlotIsNamedAtOnce) {
  const dermis_graph graph = make_bound_graph();
  dermis_frame one = frame({});
  one.bindings = nullptr;
  EXPECT_THAT(record(graph, one), Fails(DERMIS_ERROR_ARGUMENT, "'lighting'", "'depth'",
                                        "'material'", Not(HasSubstr("'albedo'"))));
}

TEST_F(Record, EveryWrongFieldIsNamedAndNothingIsRecorded) {
  const dermis_graph graph = make_bound_graph();
  const auto good = bindings(graph);
  {
    dermis_frame first = frame(good);
    ASSERT_OK(record(graph, first));
  }
  const auto light = texels("lighting");
  using Change = std::function<void(dermis_frame&, std::vector<dermis_image_binding>&)>;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<std::pair<const char*, Change>> changes{
      {"struct_size", [](auto& f, auto&) { f.struct_size = 12; }},
      {"bindings is NULL", [](auto& f, auto&) { f.bindings = nullptr; }},
      {"flags", [](auto& f, auto&) { f.flags = 0x100; }},
      {"frame_index", [](auto& f, auto&) { f.frame_index = 1; }},
      {"frame_index",
       [](auto& f, auto&) {
         f.frame_index = 0;
         f.completed_frame_index = 0;
       }},
      {"completed_frame_index", [](auto& f, auto&) { f.completed_frame_index = f.frame_index; }},
      {"frames in flight", [](auto& f, auto&) { f.frame_index += 2; }},
      {"rectangle",
       [](auto& f, auto&) {
         f.rect_width = 65;
         f.rect_height = 1;
       }},
      {"rectangle",
       [](auto& f, auto&) {
         f.rect_width = 64;
         f.rect_height = 0;
       }},
      {"rectangle",
       [](auto& f, auto&) {
         f.rect_width = 1;
         f.rect_height = 1;
         f.rect_x = 0xffffffffu;
       }},
      {"rect_width", [](auto& f, auto&) { f.rect_height = 3; }},
      {"clip_from_view",
       [](auto& f, auto&) { std::fill(f.clip_from_view, f.clip_from_view + 16, 0.0f); }},
      {"clip_from_view", [](auto& f, auto&) { f.clip_from_view[0] = nan; }},
      {"matrix", [](auto& f, auto&) { f.view_from_world[3] = nan; }},
      {"jitter", [](auto& f, auto&) { f.jitter_x = nan; }},
      {"metres_per_unit", [](auto& f, auto&) { f.metres_per_unit = -1; }},
      {"exposure", [](auto& f, auto&) { f.exposure = nan; }},
      {"delta_seconds", [](auto& f, auto&) { f.delta_seconds = -1; }},
      {"depth_kind", [](auto& f, auto&) { f.depth_kind = static_cast<dermis_depth_kind>(2); }},
      {"bindings[1].struct_size", [](auto&, auto& b) { b[1].struct_size = 0; }},
      {"bindings[0].struct_size", [](auto&, auto& b) { b[0].struct_size = 8; }},
      {"bindings[0].slot is 99", [](auto&, auto& b) { b[0].slot = 99; }},
      {"a second time", [](auto&, auto& b) { b[1] = b[0]; }},
      {"bindings[0].image", [](auto&, auto& b) { b[0].image = VK_NULL_HANDLE; }},
      {"bindings[0].view",
       [](auto&, auto& b) {
         b[0].view = VK_NULL_HANDLE;
         b[0].content_id = 0;
       }},
      {"r32f", [](auto&, auto& b) { b[0].format = VK_FORMAT_R32_SFLOAT; }},
      {"63x64", [](auto&, auto& b) { b[0].width = 63; }},
      {"before.layout", [](auto&, auto& b) { b[0].before.layout = VK_IMAGE_LAYOUT_UNDEFINED; }},
      {"after.layout", [](auto&, auto& b) { b[0].after.layout = VK_IMAGE_LAYOUT_UNDEFINED; }},
      {"no stages", [](auto&, auto& b) { b[0].before.stages = 0; }},
      {"queue_family", [](auto&, auto& b) { b[0].after.queue_family = 77; }},
  };
  for (const auto& [said, change] : changes) {
    auto bound = good;
    dermis_frame wrong = frame(bound);
    change(wrong, bound);
    EXPECT_THAT(record(graph, wrong), Fails(DERMIS_ERROR_ARGUMENT, said)) << said;
    EXPECT_EQ(logged.back(), dermis_last_error());
  }
  dermis_frame no_commands = frame(good);
  EXPECT_THAT(dermis_view_record(dermis_graph_view(graph), &no_commands),
              Fails(DERMIS_ERROR_ARGUMENT, "command_buffer"));
  EXPECT_EQ(dermis_view_record(dermis_graph_view(graph), nullptr), DERMIS_ERROR_ARGUMENT);
  EXPECT_EQ(texels("lighting"), light);
  dermis_frame next = frame(good);
  EXPECT_OK(record(graph, next)) << "the graph runs on";
}

TEST_F(Record, NewerStructs_ZeroNewFieldsAreAccepted) {
  const dermis_graph graph = make_bound_graph();
  struct NewerBinding {
    dermis_image_binding known;
    uint64_t unknown = 0;
  };
  std::vector<NewerBinding> bound;
  for (const auto& binding : bindings(graph)) {
    bound.push_back({binding, 0});
    bound.back().known.struct_size = sizeof(NewerBinding);
  }
  struct NewerFrame {
    dermis_frame known;
    uint64_t unknown = 0;
  } newer{frame({}), 0};
  newer.known.struct_size = sizeof newer;
  newer.known.bindings = &bound[0].known;
  newer.known.binding_count = static_cast<uint32_t>(bound.size());
  EXPECT_OK(record(graph, newer.known));
  newer.known.frame_index = last_frame + 1;
  newer.known.completed_frame_index = last_frame;
  newer.unknown = 1;
  EXPECT_EQ(record(graph, newer.known), DERMIS_ERROR_VERSION);
  newer.unknown = 0;
  bound[1].unknown = 1;
  EXPECT_EQ(record(graph, newer.known), DERMIS_ERROR_VERSION);
}

} // namespace
} // namespace dermis::abi_test
