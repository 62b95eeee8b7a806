// Tests the reported state of histories: validity, age, and why a history was last invalid.

#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <algorithm>
#include <cstring>

namespace dermis::abi_test {
namespace {

struct Histories : DermisTest {
  dermis_graph graph = nullptr;

  // `resize` and `when` apply to the accumulated light.
  GraphOptions keeping(const std::string& graph_name, const std::string& resize = "rescale",
                       const std::string& when = "") const {
    std::string overlay = read_text("configs/overlays/accumulate.json");
    for (size_t at = 0; (at = overlay.find("\"rescale\"", at)) != std::string::npos;
         at += resize.size())
      overlay.replace(at, 9, '"' + resize + '"');
    if (!when.empty()) {
      const std::string pass = R"("pass": "accumulate",)", clear = R"("pass": "clear_past",)",
                        condition = R"("when": ")" + when + R"(",)";
      overlay = replaced(overlay, pass,
                         pass + condition + R"( "otherwise": { "accumulated": "scattered" },)");
      overlay = replaced(overlay, clear, clear + condition);
    }
    GraphOptions options = shipped_options(dermis::shipped::graph_file(graph_name));
    options.overlays = {overlay};
    options.unbound.emplace_back("velocity");
    return options;
  }
  void make(const GraphOptions& options) { graph = make_bound_graph(options); }
  void run(int frames, uint32_t flags = 0) {
    for (int i = 0; i < frames; ++i) {
      const auto bound = bindings(graph);
      dermis_frame one = frame(bound, images.at("depth").width, images.at("depth").height);
      one.flags = flags;
      ASSERT_OK(record(graph, one));
    }
  }
  static std::vector<dermis_history> reported(dermis_graph graph) {
    return list_of(dermis_history DERMIS_HISTORY_INIT, dermis_view_histories,
                   dermis_graph_view(graph));
  }
  static dermis_history named(const std::vector<dermis_history>& all, const char* name) {
    const auto found = std::ranges::find_if(
        all, [&](const dermis_history& one) { return std::strcmp(one.name, name) == 0; });
    EXPECT_NE(found, all.end()) << name;
    return found != all.end() ? *found : dermis_history DERMIS_HISTORY_INIT;
  }
  void expect(uint32_t age, dermis_history_reason reason, const char* text) const {
    std::vector<std::string> names;
    for (const dermis_history& one : reported(graph)) {
      if (std::strncmp(one.name, "past", 4) != 0) continue; // The graph's own histories.
      names.emplace_back(one.name);
      EXPECT_EQ(one.valid, age > 0 ? 1u : 0u);
      EXPECT_EQ(one.age, age);
      EXPECT_EQ(one.reason, reason);
      EXPECT_THAT(one.text, HasSubstr(text));
    }
    EXPECT_THAT(names, testing::UnorderedElementsAre("past", "past_place"));
  }
};

TEST_F(Histories, AgeGrowsAndACutIsReported) {
  make(keeping("burley"));
  expect(0, DERMIS_HISTORY_NEVER_WRITTEN, "nothing has been recorded");
  run(3);
  expect(3, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
  run(1, DERMIS_FRAME_RESET_HISTORY);
  expect(1, DERMIS_HISTORY_CUT, "camera cut"); // Written by the frame of the cut.
  run(2);
  expect(3, DERMIS_HISTORY_CUT, "camera cut");
}

TEST_F(Histories, SurviveReloadAndRescale) {
  make(keeping("burley"));
  run(2);
  const std::string text = read_text("configs/graphs/burley.json");
  ASSERT_OK(reload_text(graph, source_of(text, "graph.json")));
  expect(2, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
  run(1);
  expect(3, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
  ASSERT_OK(dermis_graph_resize(graph, 48, 40, nullptr));
  expect(3, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
  make_images(graph);
  run(1);
  expect(4, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");

  make(keeping("burley", "invalidate"));
  run(2);
  ASSERT_OK(dermis_graph_resize(graph, 48, 40, nullptr));
  expect(0, DERMIS_HISTORY_RESIZED, "resized");
  make_images(graph);
  run(1);
  expect(1, DERMIS_HISTORY_RESIZED, "resized");
}

TEST_F(Histories, Surviving_AreNotReportedAsRestarted) {
  make(keeping("burley"));
  run(2);
  dermis_report report = nullptr;
  ASSERT_OK(dermis_graph_resize(graph, 48, 40, &report));
  EXPECT_THAT(take(report).names, Not(Contains("history_restarts")));
  make(keeping("burley", "invalidate"));
  run(2);
  ASSERT_OK(dermis_graph_resize(graph, 48, 40, &report));
  const Said said = take(report);
  EXPECT_EQ(std::count(said.names.begin(), said.names.end(), "history_restarts"), 2);
}

// Returns the names of the histories that a report lists as restarted.
std::vector<std::string> restarted(const Said& said) {
  std::vector<std::string> names;
  for (size_t i = 0; i < said.names.size(); ++i) {
    if (said.names[i] != "history_restarts") continue;
    const size_t first = said.texts[i].find('\'') + 1;
    names.push_back(said.texts[i].substr(first, said.texts[i].find('\'', first) - first));
  }
  return names;
}

TEST_F(Histories, Reload_ReportsOnlyRestartedOnes) {
  make(keeping("burley"));
  run(2);
  dermis_report report = nullptr;
  ASSERT_OK(reload_graph(graph, keeping("burley"), &report));
  EXPECT_THAT(restarted(take(report)), IsEmpty());
  GraphOptions changed = keeping("burley");
  std::string& overlay = changed.overlays.front();
  overlay = replaced(
      overlay, // Declaration of `past`.
      R"("size": "view", "history": { "frames": 1, "on_resize": "rescale" })",
      R"("size": "view", "border": 1, "history": { "frames": 1, "on_resize": "invalidate" })");
  ASSERT_OK(reload_graph(graph, changed, &report));
  EXPECT_THAT(restarted(take(report)), ElementsAre("past"));
  ASSERT_OK(reload_graph(graph, changed, &report));
  EXPECT_THAT(restarted(take(report)), ElementsAre("past")) << "nothing was recorded in between";
  run(1);
  ASSERT_OK(reload_graph(graph, changed, &report));
  EXPECT_THAT(restarted(take(report)), IsEmpty());
}

TEST_F(Histories, SettingThatKeepsThePasses_KeepsAll) {
  make(keeping("burley"));
  run(2);
  for (const auto& [name, value] : {std::pair{"samples", "8"}, {"texturing", "\"pre_post\""}}) {
    dermis_report report = nullptr;
    ASSERT_OK(dermis_graph_set_setting(graph, name, value, &report));
    EXPECT_THAT(restarted(take(report)), IsEmpty()) << name;
    run(1);
  }
  expect(4, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
}

TEST_F(Histories, OtherProfile_KeepsAll) {
  make(keeping("burley"));
  run(2);
  const std::string wax = read_text("configs/profiles/wax.json");
  const dermis_source source = source_of(wax, "wax.json");
  dermis_report report = nullptr;
  ASSERT_OK(dermis_graph_set_profile(graph, 1, &source, &report));
  EXPECT_THAT(restarted(take(report)), IsEmpty());
  run(1);
  expect(3, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
}

TEST_F(Histories, ReenabledPasses_RestartTheirHistories) {
  make(keeping("skin", "rescale", "technique == 'sap'"));
  run(2);
  for (const auto& [value, names] :
       {std::pair<const char*, std::vector<std::string>>{"\"separable\"", {}},
        {"\"sap\"", {"past", "past_place"}}}) {
    dermis_report report = nullptr;
    ASSERT_OK(dermis_graph_set_setting(graph, "technique", value, &report));
    EXPECT_THAT(restarted(take(report)), testing::UnorderedElementsAreArray(names)) << value;
    run(1);
  }
}

TEST_F(Histories, RemovingTheLastProfile_DropsHistories) {
  make(keeping("burley"));
  run(2);
  const std::string skin = read_text("configs/profiles/skin.json");
  const dermis_source source = source_of(skin, "skin.json");
  dermis_report report = nullptr;
  ASSERT_OK(dermis_graph_set_profile(graph, 1, nullptr, &report));
  EXPECT_THAT(restarted(take(report)), IsEmpty()) << "nothing needs a history";
  ASSERT_OK(dermis_graph_set_profile(graph, 1, &source, &report));
  EXPECT_THAT(restarted(take(report)), IsEmpty()) << "nothing was recorded in between";
  expect(2, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
  ASSERT_OK(dermis_graph_set_profile(graph, 1, nullptr, nullptr));
  run(1);
  ASSERT_OK(dermis_graph_set_profile(graph, 1, &source, &report));
  EXPECT_THAT(restarted(take(report)), testing::UnorderedElementsAre("past", "past_place"));
}

TEST_F(Histories, NewAfterAReload_AreReportedAsNew) {
  const std::string text = read_text("configs/graphs/papers/sap_residual.json");
  GraphOptions options;
  options.text = text;
  for (const auto& [from, to] :
       {std::pair<std::string, std::string>{R"("ratio": {)", R"("mending": {)"},
        {R"("ratio@-1")", R"("mending@-1")"},
        {R"("ratio_out": "ratio")", R"("ratio_out": "mending")"}})
    options.text = replaced(options.text, from, to);
  options.unbound = {"albedo",        "scatter_scale",   "velocity", "thickness",
                     "back_lighting", "scattered_light", "sampling"};
  make(options);
  run(2);
  ASSERT_OK(reload_text(graph, source_of(text, "graph.json")));
  const auto before = reported(graph);
  ASSERT_EQ(before.size(), 2u); // Ratio and position.
  EXPECT_EQ(named(before, "ratio").valid, 0u);
  EXPECT_EQ(named(before, "ratio").reason, DERMIS_HISTORY_RELOADED);
  EXPECT_EQ(named(before, "place").age, 2u);
  run(1);
  const auto after = reported(graph);
  EXPECT_EQ(named(after, "ratio").age, 1u);
  EXPECT_EQ(named(after, "ratio").reason, DERMIS_HISTORY_RELOADED);
  EXPECT_EQ(named(after, "place").age, 3u);
  EXPECT_EQ(named(after, "place").reason, DERMIS_HISTORY_NEVER_WRITTEN);
}

TEST_F(Histories, EmptyFrames_InvalidateHistories) {
  make(keeping("burley"));
  run(2);
  run(1, DERMIS_FRAME_BOUNDS); // Empty bounds.
  expect(0, DERMIS_HISTORY_LEFT_OUT, "without the passes that write it");
  run(1);
  expect(1, DERMIS_HISTORY_LEFT_OUT, "without the passes that write it");
}

TEST_F(Histories, PlanThatDidNotRun_HasInvalidHistories) {
  make(keeping("skin", "rescale", "technique == 'sap'"));
  expect(0, DERMIS_HISTORY_NEVER_WRITTEN, "nothing has been recorded");
  run(2);
  expect(2, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
  // Too little for anything: the fastest configuration runs, which stores no light.
  dermis_budget budget = budget_of(1e-4f, DERMIS_BUDGET_DETERMINISTIC);
  ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  run(1);
  expect(0, DERMIS_HISTORY_OTHER_PLAN, "another plan");
  budget.milliseconds = 0;
  ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  run(1);
  expect(1, DERMIS_HISTORY_OTHER_PLAN, "another plan");
}

TEST_F(Histories, DiscardedFrame_HasNoEffect) {
  make(keeping("burley"));
  run(2);
  dermis_frame one = bound_frame(graph);
  one.flags = DERMIS_FRAME_RESET_HISTORY;
  record_unsubmitted(graph, one);
  expect(1, DERMIS_HISTORY_CUT, "camera cut");
  ASSERT_OK(dermis_view_discard(dermis_graph_view(graph), one.frame_index));
  expect(2, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
}

TEST_F(Histories, ViewsHaveSeparateHistories) {
  make(keeping("burley"));
  dermis_view view = view_of(graph);
  run(2);
  uint32_t count = 1;
  dermis_history first = DERMIS_HISTORY_INIT;
  EXPECT_EQ(dermis_view_histories(view, &count, &first), DERMIS_INCOMPLETE);
  EXPECT_EQ(count, 2u);
  EXPECT_STREQ(first.name, "past");
  EXPECT_EQ(first.age, 0u);
  expect(2, DERMIS_HISTORY_NEVER_WRITTEN, "valid since its first frame");
}

TEST_F(Histories, GraphWithoutHistories_ReportsNone) {
  graph = make_graph();
  EXPECT_TRUE(reported(graph).empty());
}

} // namespace
} // namespace dermis::abi_test
