// Tests frames in flight: replaced objects live until the device has finished with them.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/abi/in_flight.hpp"

namespace dermis::abi_test {
namespace {

struct InFlight : InFlightTest {
  void run(dermis_graph graph, const std::vector<dermis_image_binding>& bound, uint64_t index) {
    dermis_frame one = frame(bound);
    one.frame_index = index;
    one.completed_frame_index = completed_before(index);
    submit(index, [&](VkCommandBuffer into) {
      one.command_buffer = into;
      ASSERT_EQ(dermis_view_record(dermis_graph_view(graph), &one), DERMIS_OK) << dermis_last_error();
    });
    last_frame = index;
  }
};

// Plans of one graph share memory. Without a wait in between, only their own barriers order them.
TEST_F(InFlight, AlternatingPlans_WaitForTheSharedMemory) {
  GraphOptions options;
  options.text = read_text("configs/graphs/skin.json");
  const dermis_graph graph = make_graph(options);
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  for (uint64_t index = 1; index <= 9; ++index) {
    dermis_budget budget = DERMIS_BUDGET_INIT;
    // The fastest configuration, or the defaults.
    budget.milliseconds = index % 2 == 0 ? 0.001f : 0;
    budget.flags = DERMIS_BUDGET_DETERMINISTIC;
    ASSERT_EQ(dermis_graph_set_budget(graph, &budget, nullptr), DERMIS_OK) << dermis_last_error();
    run(graph, bound, index);
  }
  host->vk.vkDeviceWaitIdle(host->device);
  demo::ReportedFrame choice;
  ASSERT_EQ(demo::read_reported(dermis_graph_view(graph), 9, choice), DERMIS_OK) << dermis_last_error();
  EXPECT_STREQ(choice.configuration, "technique=sap, variant=smooth");
  ASSERT_EQ(choice.frame_index, 9u);
}

TEST_F(InFlight, ReplacedPlan_LivesUntilItsFramesFinish) {
  const dermis_graph graph = make_graph();
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  const std::string text = read_text("configs/graphs/burley.json");
  const dermis_source source = source_of(text, "burley.json");
  for (uint64_t index = 1; index <= 8; ++index) {
    run(graph, bound, index);
    ASSERT_EQ(reload_text(graph, source), DERMIS_OK) << dermis_last_error();
  }
  // In TearDown the validation layer reports objects that were destroyed while in use.
}

TEST_F(InFlight, TimesSurviveTheReuseOfTheirQueries) {
  const dermis_graph graph = make_graph();
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  std::array<dermis_pass_timing, 16> times{};
  times[0].struct_size = sizeof times[0];
  for (uint64_t index = 1; index <= 6; ++index) {
    run(graph, bound, index);
    // The frame whose queries this frame reused.
    const uint64_t completed = completed_before(index);
    if (completed == 0) continue;
    uint32_t count = 16;
    ASSERT_EQ(dermis_view_timings(dermis_graph_view(graph), completed, &count, times.data()), DERMIS_OK);
    EXPECT_EQ(times[0].frame_index, completed);
    EXPECT_GT(times[0].nanoseconds, 0u);
  }
}

TEST_F(InFlight, FramesFollowEachOtherWithoutWaiting) {
  const dermis_graph graph = make_graph();
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  for (uint64_t index = 1; index <= 6; ++index)
    run(graph, bound, index);
  host->vk.vkDeviceWaitIdle(host->device);
  std::array<dermis_pass_timing, 16> times{};
  times[0].struct_size = sizeof times[0];
  uint32_t count = 16;
  ASSERT_EQ(dermis_view_timings(dermis_graph_view(graph), 6, &count, times.data()), DERMIS_OK)
      << dermis_last_error();
  EXPECT_EQ(times[0].frame_index, 6u);
  ASSERT_EQ(dermis_view_timings(dermis_graph_view(graph), 5, &count, times.data()), DERMIS_OK)
      << dermis_last_error();
  EXPECT_EQ(times[0].frame_index, 5u);
}

} // namespace
} // namespace dermis::abi_test
