// Tests choices in graphs that count no tiles: they have no subsurface.classify.

#include "tests/integration/abi/sources.hpp"
#include "tests/integration/embedding/null_host.hpp"

namespace dermis::abi_test {
namespace {

void DERMIS_CALL do_nothing(void*, const dermis_pass_call*) {}

const std::string graph_text = R"({ "dermis": 2, "name": "host_passes",
  "settings": { "quality": { "choice": ["low", "high"], "by": "budget", "default": "low" } },
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "passes": [
    { "pass": "fast", "type": "studio.fast", "write": { "picture": "light" }, "when": "quality == 'low'" },
    { "pass": "exact", "type": "studio.exact", "write": { "picture": "light" }, "when": "quality == 'high'" } ],
  "exports": ["light"] })";
const std::string errors_text = R"({ "dermis_errors": 2, "scenes": "invented",
  "unscattered": [[1, 0.03]], "techniques": [
    { "name": "fast", "pass_types": [{ "type": "studio.fast" }], "rmse": [[1, 0.02]] },
    { "name": "exact", "pass_types": [{ "type": "studio.exact" }], "rmse": [[1, 0.001]] } ] })";
const std::string calibration_text = R"({ "dermis_calibration": 2, "device": "invented", "costs": [
  { "work": "studio.fast", "base_us": 1000, "group_us": 0, "spread": 0 },
  { "work": "studio.exact", "base_us": 5000, "group_us": 0, "spread": 0 } ] })";

struct UncountedChoice : ::testing::Test {
  NullHost host;

  void SetUp() override {
    ASSERT_OK(host.make_context(host.context_desc()));
    dermis_port port = port_of("picture", DERMIS_PORT_STORAGE_IMAGE_UPDATE);
    for (const char* name : {"studio.fast", "studio.exact"}) {
      const dermis_pass_type type = pass_type_of(name, {&port, 1}, do_nothing, nullptr);
      ASSERT_OK(dermis_register_pass_type(host.context, &type));
    }
    dermis_graph_desc desc = graph_desc(graph_text, "graph.json", 64);
    ASSERT_OK(dermis_graph_create(host.context, &desc, &host.graph, nullptr));
    host.make_bindings();
  }
  void set_budget(float milliseconds) const {
    const dermis_source errors = source_of(errors_text, "errors.json"),
                        calibration = source_of(calibration_text, "calibration.json");
    dermis_budget budget = budget_of(milliseconds, DERMIS_BUDGET_DETERMINISTIC);
    budget.errors = &errors;
    budget.calibration = &calibration;
    ASSERT_OK(dermis_graph_set_budget(host.graph, &budget, nullptr));
  }
  void change_budget(float milliseconds) const {
    const dermis_budget budget = budget_of(milliseconds, DERMIS_BUDGET_DETERMINISTIC);
    ASSERT_OK(dermis_graph_set_budget(host.graph, &budget, nullptr));
  }
  // Records a number of frames at 60 Hz and returns the report of the last.
  dermis_frame_report run(int frames) {
    for (int i = 0; i < frames; ++i)
      EXPECT_OK(host.record());
    dermis_frame_report report = DERMIS_FRAME_REPORT_INIT;
    EXPECT_OK(dermis_view_report(dermis_graph_view(host.graph), host.last_frame, &report));
    return report;
  }
};

TEST_F(UncountedChoice, FollowsTheBudget) {
  set_budget(2);
  EXPECT_STREQ(run(10).configuration, "quality=low");
  change_budget(10);
  EXPECT_STREQ(run(300).configuration, "quality=high");
  change_budget(2);
  const dermis_frame_report report = run(300);
  EXPECT_STREQ(report.configuration, "quality=low");
  EXPECT_EQ(report.skips & DERMIS_SKIP_NOTHING_SEEN, 0u);
}

// The budget alternates between two that would each choose another configuration.
TEST_F(UncountedChoice, SwitchesAreLimited) {
  set_budget(10);
  run(300);
  dermis_frame_statistics before = DERMIS_FRAME_STATISTICS_INIT, after = before;
  const dermis_view view = dermis_graph_view(host.graph);
  ASSERT_OK(dermis_view_statistics(view, host.last_frame, &before));
  for (int i = 0; i < 120; ++i) { // two seconds
    change_budget(i % 2 == 0 ? 2.0f : 10.0f);
    run(1);
  }
  ASSERT_OK(dermis_view_statistics(view, host.last_frame, &after));
  EXPECT_GE(after.switches, before.switches + 1);
  EXPECT_LE(after.switches, before.switches + 3);
}

} // namespace
} // namespace dermis::abi_test
