// Tests a frame: its effect on the light, and every field that can be wrong.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <cmath>

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
  ASSERT_OK(dermis_view_timings(dermis_graph_view(graph), last_frame + 1, &count, times.data()));
  EXPECT_EQ(times[0].frame_index, last_frame);
}

TEST_F(Record, EveryMissingSlotIsNamedAtOnce) {
  const dermis_graph graph = make_bound_graph();
  dermis_frame one = frame({});
  one.bindings = nullptr;
  EXPECT_THAT(record(graph, one), Fails(DERMIS_ERROR_ARGUMENT, "'lighting'", "'depth'",
                                        "'material'", Not(HasSubstr("'albedo'"))));
}

// Frames.WrongField_IsNamed checks every field.
TEST_F(Record, WrongFrame_IsLoggedAndNothingIsRecorded) {
  const dermis_graph graph = make_bound_graph();
  const auto good = bindings(graph);
  {
    dermis_frame first = frame(good);
    ASSERT_OK(record(graph, first));
  }
  const auto light = texels("lighting");
  dermis_frame wrong = frame(good);
  wrong.exposure = -1;
  EXPECT_THAT(record(graph, wrong), Fails(DERMIS_ERROR_ARGUMENT, "exposure"));
  EXPECT_EQ(logged.back(), dermis_last_error());
  auto bound = good;
  bound[0].before.stages = 0;
  wrong = frame(bound);
  EXPECT_THAT(record(graph, wrong), Fails(DERMIS_ERROR_ARGUMENT, "no stages"));
  EXPECT_EQ(logged.back(), dermis_last_error());
  EXPECT_EQ(texels("lighting"), light);
  dermis_frame next = frame(good);
  EXPECT_OK(record(graph, next)) << "the graph runs on";
}

} // namespace
} // namespace dermis::abi_test
