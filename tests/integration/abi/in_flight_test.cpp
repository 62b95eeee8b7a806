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
      ASSERT_OK(dermis_view_record(dermis_graph_view(graph), &one));
    });
    last_frame = index;
  }
};

// Plans of one graph share memory. Without a wait in between, only their own barriers order them.
TEST_F(InFlight, AlternatingPlans_WaitForTheSharedMemory) {
  GraphOptions options = shipped_options("configs/graphs/skin.json");
  const dermis_graph graph = make_bound_graph(options);
  const auto bound = bindings(graph);
  for (uint64_t index = 1; index <= 9; ++index) {
    // The fastest configuration, or the defaults.
    dermis_budget budget = budget_of(index % 2 == 0 ? 0.001f : 0, DERMIS_BUDGET_DETERMINISTIC);
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
    run(graph, bound, index);
  }
  host->vk.vkDeviceWaitIdle(host->device);
  demo::ReportedFrame choice;
  ASSERT_OK(demo::read_reported(dermis_graph_view(graph), 9, choice));
  EXPECT_STREQ(choice.configuration, "technique=sap, variant=smooth");
  ASSERT_EQ(choice.frame_index, 9u);
}

TEST_F(InFlight, ReplacedPlan_LivesUntilItsFramesFinish) {
  const dermis_graph graph = make_bound_graph();
  const auto bound = bindings(graph);
  const std::string text = read_text("configs/graphs/burley.json");
  for (uint64_t index = 1; index <= 8; ++index) {
    run(graph, bound, index);
    ASSERT_OK(reload_text(graph, source_of(text, "burley.json")));
  }
  // In TearDown the validation layer reports objects that were destroyed while in use.
}

TEST_F(InFlight, TimesSurviveTheReuseOfTheirQueries) {
  const dermis_graph graph = make_bound_graph();
  const auto bound = bindings(graph);
  std::array<dermis_pass_timing, 16> times{};
  times[0].struct_size = sizeof times[0];
  for (uint64_t index = 1; index <= 6; ++index) {
    run(graph, bound, index);
    // The frame whose queries this frame reused.
    const uint64_t completed = completed_before(index);
    if (completed == 0) continue;
    uint32_t count = 16;
    ASSERT_OK(dermis_view_timings(dermis_graph_view(graph), completed, &count, times.data()));
    EXPECT_EQ(times[0].frame_index, completed);
    EXPECT_GT(times[0].nanoseconds, 0u);
  }
}

TEST_F(InFlight, FramesFollowEachOtherWithoutWaiting) {
  const dermis_graph graph = make_bound_graph();
  const auto bound = bindings(graph);
  for (uint64_t index = 1; index <= 6; ++index)
    run(graph, bound, index);
  host->vk.vkDeviceWaitIdle(host->device);
  std::array<dermis_pass_timing, 16> times{};
  times[0].struct_size = sizeof times[0];
  uint32_t count = 16;
  ASSERT_OK(dermis_view_timings(dermis_graph_view(graph), 6, &count, times.data()));
  EXPECT_EQ(times[0].frame_index, 6u);
  ASSERT_OK(dermis_view_timings(dermis_graph_view(graph), 5, &count, times.data()));
  EXPECT_EQ(times[0].frame_index, 5u);
}

} // namespace
} // namespace dermis::abi_test
