// Tests reports of benches: the contents of every format, and their numbers.
#include "integration/tools/command/bench/report/html.hpp"
#include "integration/tools/command/bench/report/pareto.hpp"
#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/subject.hpp"
#include "integration/tools/command/run/pass_times.hpp"
#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "integration/tools/files/heat_color.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <cmath>

namespace dermis::tools {
namespace {

Report small_report() {
  Report report;
  report.bench = "test";
  report.title = "Title <&>";
  report.info = {{"command", "dermis \"x\""}};
  report.table.columns = {{"name", "name"}, {"value", "value"}, {"best", "best"}};
  report.table.rows = {{std::string("a,b \"c\""), 0.1, true},
                       {std::string("plain"), ReportValue(), false}};
  report.plots = {
      {"plot", "x", "y", {{"series", {{1, 2, "point", true}, {10, 1, "other", true}}}}}};
  report.pictures = {{"maps", "words", {{"one", 2, 1, {0, 0, 0, 255, 255, 255}}}}};
  return report;
}

TEST(ReportFiles, JsonIsOneDocumentWithNullForUnmeasured) {
  const std::string text = report_as_json(small_report());
  EXPECT_TRUE(test::is_json(text));
  EXPECT_THAT(text,
              HasAll(R"({ "name": "a,b \"c\"", "value": 0.1, "best": true })", R"("value": null)"));
}

TEST(ReportFiles, CsvQuotesSpecialCharacters) {
  EXPECT_EQ(report_as_csv(small_report()),
            "name,value,best\r\n\"a,b \"\"c\"\"\",0.1,true\r\nplain,,false\r\n");
}

TEST(ReportFiles, HtmlEscapesTextAndLoadsNothingFromElsewhere) {
  const std::string page = report_as_html(small_report());
  EXPECT_THAT(page, HasAll("<h1>Title &lt;&amp;&gt;</h1>", "dermis &quot;x&quot;",
                           "data:image/png;base64,iVBORw0KGgo", "prefers-color-scheme:dark"));
  for (const char* loaded : {"http:", "https:", "<link", "src='/", "@import"})
    EXPECT_THAT(page, Not(HasSubstr(loaded)));
}

// A logarithmic axis has no place for 0 and for infinity.
TEST(ReportFiles, PlotsLeaveOutPointsWithoutAPlace) {
  Report report = small_report();
  for (const double value : {0.0, -1.0, HUGE_VAL, double(NAN)})
    for (const auto& [x, y] : {std::pair(value, 1.0), std::pair(1.0, value)})
      report.plots[0].series[0].points.push_back({x, y, "unseen", true});
  EXPECT_THAT(report_as_html(report), AllOf(HasSubstr("<title>other</title>"),
                                            Not(HasSubstr("unseen")), Not(HasSubstr("nan"))));
  for (PlotSeries& series : report.plots[0].series)
    series.points = {{0, HUGE_VAL, "unseen", false}};
  EXPECT_THAT(report_as_html(report), Not(HasSubstr("unseen")));
}

TEST(HeatColor, NotANumber_IsTheLargestError) {
  EXPECT_EQ(heat_color(NAN), heat_color(1));
  EXPECT_NE(heat_color(NAN), heat_color(0));
}

// A frame may run other passes than the frame before.
TEST(PassTimes, TotalIsOfWhatAFrameRan) {
  PassTimes times;
  for (int i = 0; i < 3; ++i) {
    times.begin_frame();
    times.add("list", 1);
    times.add(i == 1 ? "sap" : "separable", 2);
  }
  EXPECT_EQ(times.total(), 3);
  EXPECT_EQ(times.frames(), 3u);
  EXPECT_EQ(times.rows().size(), 3u);
}

TEST(ReportFiles, BaselinesAreGreyAndOwnTechniquesAreNot) {
  for (const char* own : {"sap", "sap_residual", "hybrid", "restir"})
    EXPECT_FALSE(is_baseline(own)) << own;
  for (const char* other : {"fixed", "separable", "afis", "pyramid", "burley"})
    EXPECT_TRUE(is_baseline(other)) << other;
  Report report = small_report();
  EXPECT_THAT(report_as_html(report), Not(HasSubstr("s0 base")));
  report.plots[0].series[0].baseline = true;
  EXPECT_THAT(report_as_html(report), HasSubstr("<g class='s0 base b0'>"));
}

TEST(ReportFiles, JsonOmitsObjectsThatWereNotMeasured) {
  Report report;
  report.constants = {{"clock", "thread"}};
  report.table.columns = {{"time.low", ""}, {"time.high", "high"}, {"size", "size"}};
  report.table.rows = {{1.5, 2.5, 3}, {ReportValue(), ReportValue(), 4}};
  const std::string text = report_as_json(report);
  EXPECT_TRUE(test::is_json(text));
  EXPECT_THAT(text, HasSubstr(R"("clock": "thread",)"));
  EXPECT_THAT(text, HasSubstr(R"({ "time": { "low": 1.5, "high": 2.5 }, "size": 3 })"));
  EXPECT_THAT(text, HasSubstr(R"({ "size": 4 })"));
}

TEST(ReportFiles, TextHasRulesBetweenGroups) {
  Report report = small_report();
  report.table.columns[0].style.groups = true;
  report.table.columns[2].style.in_text = false;
  report.notes = {"reason"};
  EXPECT_EQ(report_as_text(report), "name     value\n"
                                    "-------  -----\n"
                                    "a,b \"c\"    0.1\n"
                                    "-------  -----\n"
                                    "plain        -\n"
                                    "left out: reason\n"
                                    "command: dermis \"x\"\n");
}

TEST(ReportFiles, NumbersHaveSignificantDigitsAndNoPowers) {
  const auto text = [](double value, int digits) {
    return cell_text(value, {"key", "title", {digits}});
  };
  EXPECT_EQ(text(1234.5, 3), "1234");
  EXPECT_EQ(text(12.345, 4), "12.35");
  EXPECT_EQ(text(0.00012345, 3), "0.000123");
  EXPECT_EQ(text(0, 3), "0");
}

TEST(ReportFiles, VerdictNamesMissedGoalsThatAreNotRequired) {
  ReportTable table;
  table.columns = {{"holds", "holds", {.goal = Goal::required}},
                   {"fast", "fast", {.goal = Goal::advisory}}};
  table.rows = {{true, true}, {true, true}};
  EXPECT_EQ(verdict_of(table), "all goals of 2 rows are met");
  table.rows[0][1] = false;
  EXPECT_EQ(verdict_of(table), "1 of 2 rows miss a goal that is not required");
  table.rows[1][0] = false;
  EXPECT_EQ(verdict_of(table), "1 of 2 rows miss a goal");
  table.rows = {{ReportValue(), ReportValue()}};
  EXPECT_EQ(verdict_of(table), "");
}

TEST(ReportFiles, RowsThatMissTheirGoalsAreCountedAndMarked) {
  Report report;
  report.table.columns = {{"holds", "holds", {.goal = Goal::required}}, {"flag", "flag"}};
  report.table.rows = {{true, false}, {false, true}, {ReportValue(), false}, {false, false}};
  const GoalCount count = count_goals(report.table, Goal::required);
  EXPECT_EQ(count.missed, 2u);
  EXPECT_EQ(count.rows, 3u);
  EXPECT_EQ(count_goals(report.table, Goal::advisory).rows, 0u);
  const std::string page = report_as_html(report);
  EXPECT_THAT(page, HasSubstr("Marked rows miss their limits (column 'holds')."));
  EXPECT_THAT(page, HasSubstr("<tr class=bad><td data-v=0>no<td data-v=1>yes"));
  EXPECT_THAT(page, HasSubstr("<tr><td data-v=1>yes"));
}

TEST(ReportFiles, PlotsHaveTheTitleOfTheBench) {
  Report report = small_report();
  EXPECT_THAT(report_as_html(report), HasSubstr("<h2>Time against error</h2><p>Filled points"));
  report.plots_title = "Over passes";
  report.plots_text = "Point at a graph.";
  EXPECT_THAT(report_as_html(report), HasSubstr("<h2>Over passes</h2><p>Point at a graph.</p>"));
}

TEST(ReportFiles, Base64MatchesTheStandard) { // RFC 4648, section 10.
  const auto coded = [](std::string_view text) {
    return base64({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  };
  EXPECT_EQ(coded(""), "");
  EXPECT_EQ(coded("f"), "Zg==");
  EXPECT_EQ(coded("fo"), "Zm8=");
  EXPECT_EQ(coded("foo"), "Zm9v");
  EXPECT_EQ(coded("foobar"), "Zm9vYmFy");
}

TEST(Pareto, DominatedEntriesAreNotOnTheFront) {
  const std::vector<bool> front = pareto_front({{1, 5}, {2, 3}, {2, 4}, {3, 3}, {4, 1}, {4, 1}});
  // Equal entries are both on the front.
  EXPECT_EQ(front, (std::vector<bool>{true, true, false, false, true, true}));
}

subsurface::Profile skin() {
  subsurface::Profile profile;
  profile.name = "skin";
  profile.dmfp_mm = {3.673, 1.367, 0.6827};
  profile.albedo = {0.44, 0.22, 0.13};
  subsurface::derive(profile);
  return profile;
}

TEST(GeneratedScenes, WidestChannelHasTheRequestedD) {
  for (const char* scene : {"edge", "disc", "bumps", "sphere", "depth_step", "texture_plane"}) {
    ASSERT_TRUE(is_generated(scene));
    for (const double d_px : {1.0, 4.0}) {
      const CapturedFrame frame = generate_scene(scene, "close", 64, 48, d_px, skin());
      EXPECT_NEAR(median_d_px(make_reference_frame(frame).input()), d_px, 1e-6) << scene;
      for (const float light : frame.lighting.values)
        ASSERT_TRUE(std::isfinite(light) && light >= 0 && light <= 1.001f) << scene;
    }
  }
  EXPECT_FALSE(is_generated("bust"));
}

TEST(GeneratedScenes, VaryingPlaneFallsToAnEighthOfItsD) {
  const CapturedFrame frame = generate_scene("texture_plane", "varying", 64, 8, 16, skin());
  EXPECT_FLOAT_EQ(frame.scatter_scale.values.front(), 1.0f);
  EXPECT_FLOAT_EQ(frame.scatter_scale.values.back(), 0.125f);
}

} // namespace
} // namespace dermis::tools
