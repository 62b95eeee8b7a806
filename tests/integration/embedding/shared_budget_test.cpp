// Tests one budget for all views of a graph, on a device without a driver.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <numeric>

namespace dermis::abi_test {
namespace {

struct SharedBudget : ::testing::Test {
  static constexpr float budget_ms = 4;
  NullHost host;
  std::vector<dermis_view> views;
  uint64_t frame = 0;

  void SetUp() override {
    ASSERT_OK(host.start());
    views = {dermis_graph_view(host.graph), view_of(host.graph), view_of(host.graph)};
    frame = host.last_frame;
    set_budget(DERMIS_BUDGET_ALL_VIEWS);
  }
  void set_budget(uint32_t flags) const {
    const dermis_budget budget = budget_of(budget_ms, flags | DERMIS_BUDGET_DETERMINISTIC);
    ASSERT_OK(dermis_graph_set_budget(host.graph, &budget, nullptr));
  }
  // Records a frame of each view; returns their budgets.
  std::vector<float> record() {
    std::vector<float> parts;
    ++frame;
    for (const dermis_view view : views) {
      EXPECT_OK(host.record(view, frame));
      dermis_frame_report report = DERMIS_FRAME_REPORT_INIT;
      EXPECT_OK(dermis_view_report(view, frame, &report));
      EXPECT_EQ(report.frame_index, frame);
      parts.push_back(report.budget_ms);
    }
    return parts;
  }
  float sum_of_parts() {
    const std::vector<float> parts = record();
    for (const float part : parts)
      EXPECT_GT(part, 0);
    return std::accumulate(parts.begin(), parts.end(), 0.0f);
  }
};

TEST_F(SharedBudget, PartsMakeUpTheBudget) {
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(sum_of_parts(), budget_ms, 1e-4) << i;
}

TEST_F(SharedBudget, ForecastsAreOfTheViewsPart) {
  const std::vector<float> parts = record();
  for (size_t v = 0; v < views.size(); ++v) {
    dermis_forecast_desc desc = DERMIS_FORECAST_DESC_INIT;
    desc.view = views[v];
    dermis_outcome outcome = DERMIS_OUTCOME_INIT, same = outcome;
    ASSERT_OK(dermis_graph_predict(host.graph, &desc, &outcome));
    desc.milliseconds = parts[v];
    ASSERT_OK(dermis_graph_predict(host.graph, &desc, &same));
    EXPECT_STREQ(outcome.configuration, same.configuration);
    EXPECT_EQ(outcome.expected_ms, same.expected_ms);
  }
}

TEST_F(SharedBudget, DestroyedAndHiddenViews_GiveTheirPartsBack) {
  record();
  dermis_view_destroy(views.back());
  views.pop_back();
  EXPECT_NEAR(sum_of_parts(), budget_ms, 1e-4);
  views.pop_back(); // hidden
  for (int i = 0; i < 10; ++i)
    record();
  EXPECT_NEAR(record()[0], budget_ms, 1e-4);
}

TEST_F(SharedBudget, WithoutTheFlag_EachViewHasTheWholeBudget) {
  record();
  set_budget(0);
  for (const float part : record())
    EXPECT_EQ(part, budget_ms);
}

} // namespace
} // namespace dermis::abi_test
