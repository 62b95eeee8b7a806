// Tests the memory budget of a graph: plans that do not fit are neither chosen nor allocated, and
// the report says so. Runs on a device without a driver.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <algorithm>
#include <set>

namespace dermis::abi_test {
namespace {

struct MemoryBudget : ::testing::Test {
  static constexpr uint32_t side = 256;
  NullHost host;
  dermis_report report = nullptr;
  std::string text = read_text("configs/graphs/skin.json");

  void SetUp() override { ASSERT_OK(host.make_context(host.context_desc())); }
  void TearDown() override { dermis_report_destroy(report); }

  dermis_result create(uint64_t max_bytes, uint32_t size = side) {
    const dermis_profile profile = skin_profile();
    const char* unbound[] = {"albedo", "scatter_scale", "scattered_light", "importance"};
    dermis_graph_desc desc = graph_desc(text, "skin.json", size);
    desc.profiles = &profile;
    desc.profile_count = 1;
    desc.unbound = unbound;
    desc.unbound_count = static_cast<uint32_t>(std::size(unbound));
    desc.max_bytes = max_bytes;
    forget();
    dermis_graph_destroy(host.graph);
    return dermis_graph_create(host.context, &desc, &host.graph, &report);
  }
  void forget() {
    dermis_report_destroy(report);
    report = nullptr;
  }
  // Returns the text of the message with this code; "" without one.
  std::string message(uint32_t code) const {
    for (uint32_t i = 0; i < dermis_report_count(report); ++i) {
      dermis_message one = DERMIS_MESSAGE_INIT;
      EXPECT_OK(dermis_report_message(report, i, &one));
      if (one.code != code) continue;
      EXPECT_GT(one.line, 0u) << "a place in the graph";
      EXPECT_STREQ(one.file, "skin.json");
      EXPECT_THAT(one.hint, HasSubstr("dermis_graph_desc.max_bytes"));
      return one.text;
    }
    return "";
  }
  uint64_t bytes() const {
    const dermis_memory memory = memory_of(host.graph);
    return memory.transient_bytes + memory.history_bytes;
  }
  std::vector<dermis_outcome> frontier() const {
    return list_of<dermis_outcome>(DERMIS_OUTCOME_INIT, dermis_graph_frontier, host.graph,
                                   static_cast<const dermis_forecast_desc*>(nullptr));
  }
  std::set<std::string> names() const {
    std::set<std::string> all;
    for (const dermis_outcome& one : frontier())
      all.insert(one.configuration);
    return all;
  }
};

constexpr uint32_t left_out = 405, exceeded = 406;

TEST_F(MemoryBudget, EachBudgetIsKeptOrReported) {
  ASSERT_OK(create(0));
  const uint64_t all_bytes = bytes();
  const size_t all = frontier().size();
  EXPECT_EQ(dermis_report_count(report), 0u);
  size_t fewest = all;
  double least_rmse = 0;
  for (uint64_t percent = 105; percent > 0; percent -= 5) {
    const uint64_t budget = all_bytes * percent / 100;
    ASSERT_OK(create(budget));
    const std::vector<dermis_outcome> outcomes = frontier();
    EXPECT_EQ(outcomes.size() < all, !message(left_out).empty()) << percent;
    EXPECT_EQ(bytes() > budget, !message(exceeded).empty()) << percent;
    double rmse = 1;
    for (const dermis_outcome& one : outcomes)
      rmse = std::min(rmse, double(one.expected_rmse));
    EXPECT_GE(rmse, least_rmse) << percent << ": less memory never gives less error";
    least_rmse = rmse;
    if (bytes() <= budget) {
      for (const dermis_outcome& one : outcomes)
        EXPECT_LE(one.transient_bytes + one.history_bytes, budget) << one.configuration;
    }
    fewest = std::min(fewest, outcomes.size());
  }
  EXPECT_LT(fewest, all);
}

TEST_F(MemoryBudget, PlansThatDoNotFit_AllocateNothing) {
  ASSERT_OK(create(0));
  const uint64_t device_bytes = host.device.memory_bytes(), all_bytes = bytes();
  const uint64_t objects = host.device.alive();
  ASSERT_OK(create(all_bytes / 2));
  EXPECT_LE(host.device.memory_bytes(), device_bytes - all_bytes / 2);
  EXPECT_LT(host.device.alive(), objects);
  EXPECT_THAT(message(left_out), HasAll("MiB for a view of 256x256", "'technique=", "take"));
}

TEST_F(MemoryBudget, NothingFits_TheSmallestPlanRuns) {
  ASSERT_OK(create(0));
  uint64_t least = UINT64_MAX;
  for (const dermis_outcome& one : frontier())
    least = std::min(least, one.transient_bytes + one.history_bytes);
  ASSERT_OK(create(1));
  EXPECT_EQ(bytes(), least);
  EXPECT_THAT(message(exceeded), HasAll("no plan fits", "0.00 MiB", "takes"));
}

TEST_F(MemoryBudget, DefaultThatDoesNotFit_IsReplaced) {
  ASSERT_OK(create(0));
  host.make_bindings();
  ASSERT_OK(host.record());
  dermis_frame_report frame = DERMIS_FRAME_REPORT_INIT;
  ASSERT_OK(dermis_view_report(dermis_graph_view(host.graph), 1, &frame));
  const std::string usual = frame.configuration;
  uint64_t least = UINT64_MAX;
  for (const dermis_outcome& one : frontier())
    if (one.configuration == usual) least = one.transient_bytes + one.history_bytes;
  ASSERT_OK(create(least - 1));
  host.last_frame = 0;
  host.make_bindings();
  ASSERT_OK(host.record());
  ASSERT_OK(dermis_view_report(dermis_graph_view(host.graph), 1, &frame));
  EXPECT_NE(frame.configuration, usual);
  EXPECT_TRUE(names().contains(frame.configuration));
  EXPECT_FALSE(names().contains(usual));
}

TEST_F(MemoryBudget, ResizeAndReload_KeepTheBudget) {
  ASSERT_OK(create(0));
  const uint64_t all_bytes = bytes();
  const size_t all = frontier().size();
  ASSERT_OK(create(all_bytes));
  EXPECT_EQ(frontier().size(), all);
  forget();
  ASSERT_OK(dermis_graph_resize(host.graph, 2 * side, 2 * side, &report));
  EXPECT_LT(frontier().size(), all);
  EXPECT_LE(bytes(), all_bytes);
  EXPECT_THAT(message(left_out), HasSubstr("512x512"));
  forget();
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.keep = DERMIS_KEEP_ALL;
  ASSERT_OK(dermis_graph_reload(host.graph, &desc, &report));
  EXPECT_LE(bytes(), all_bytes);
  desc.keep = DERMIS_KEEP_ALL & ~DERMIS_KEEP_MEMORY; // no budget
  forget();
  ASSERT_OK(dermis_graph_reload(host.graph, &desc, &report));
  EXPECT_EQ(frontier().size(), all);
  EXPECT_EQ(message(left_out), "");
}

TEST_F(MemoryBudget, GraphWithoutChoices_IsReported) {
  text = read_text("configs/graphs/burley.json");
  ASSERT_OK(create(1));
  dermis_message one = DERMIS_MESSAGE_INIT;
  bool reported = false;
  for (uint32_t i = 0; i < dermis_report_count(report); ++i) {
    ASSERT_OK(dermis_report_message(report, i, &one));
    reported = reported || (one.code == exceeded && one.severity == DERMIS_SEVERITY_WARNING);
  }
  EXPECT_TRUE(reported);
  EXPECT_EQ(frontier().size(), 1u);
}

// A value of the view named a setting that is another kind of setting since a reload.
TEST_F(MemoryBudget, DroppedValueOfAView_DoesNotReachNewViews) {
  dermis_port port = port_of("picture", DERMIS_PORT_STORAGE_IMAGE_UPDATE);
  dermis_pass_setting weight = real_setting("weight", 1);
  weight.per_frame = 1;
  dermis_pass_type type =
      pass_type_of("studio.mix", {&port, 1}, [](void*, const dermis_pass_call*) {});
  type.settings = &weight;
  type.setting_count = 1;
  ASSERT_OK(dermis_register_pass_type(host.context, &type));
  const std::string shipped = text;
  text =
      R"({ "dermis": 2, "name": "before", "settings": { "variant": { "real": 0.5, "min": 0, "max": 1 } },
    "imports": { "lighting": { "format": "rgba16f", "size": "view" } },
    "passes": [ { "pass": "mix", "type": "studio.mix", "write": { "picture": "lighting" },
      "set": { "weight": "$variant" } } ], "exports": ["lighting"] })";
  const dermis_profile profile = skin_profile();
  dermis_graph_desc desc = graph_desc(text, "before.json", side);
  desc.profiles = &profile;
  desc.profile_count = 1;
  ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
  ASSERT_OK(dermis_view_set_setting(dermis_graph_view(host.graph), "variant", "0.75", nullptr));
  desc = graph_desc(shipped, "skin.json", side);
  desc.keep = DERMIS_KEEP_ALL & ~DERMIS_KEEP_SOURCE;
  ASSERT_OK(dermis_graph_reload(host.graph, &desc, nullptr));
  dermis_view other = nullptr;
  ASSERT_OK(dermis_view_create(host.graph, nullptr, &other, nullptr));
  dermis_forecast_desc of_view = DERMIS_FORECAST_DESC_INIT;
  of_view.view = other;
  const auto expected = frontier();
  const auto found = list_of<dermis_outcome>(DERMIS_OUTCOME_INIT, dermis_graph_frontier, host.graph,
                                             static_cast<const dermis_forecast_desc*>(&of_view));
  ASSERT_EQ(found.size(), expected.size());
  ASSERT_GT(found.size(), 4u);
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_STREQ(found[i].configuration, expected[i].configuration);
    EXPECT_EQ(found[i].expected_rmse, expected[i].expected_rmse) << found[i].configuration;
    EXPECT_EQ(found[i].expected_ms, expected[i].expected_ms) << found[i].configuration;
  }
  dermis_view_destroy(other);
}

} // namespace
} // namespace dermis::abi_test
