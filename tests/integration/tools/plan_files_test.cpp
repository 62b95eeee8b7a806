// Tests `dermis plan`: a saved plan can be verified on its own and compared with the graph's
// present plan.

#include "framegraph/serialize/plan_file.hpp"
#include "tests/integration/tools/command_fixture.hpp"

namespace dermis::test {
namespace {

using PlanFiles = CommandTest;

TEST_F(PlanFiles, HelpOfEveryVerbShowsAnExample) {
  for (const std::string verb : {"diff", "save", "verify"}) {
    EXPECT_THAT(run({"plan", verb, "--help"}), Succeeds("Example:\n  dermis plan " + verb));
  }
  EXPECT_EQ(run({"plan"}).exit_code, 2);
}

TEST_F(PlanFiles, EqualGraphs_GiveEqualBytesThatVerify) {
  for (const char* file : {"a.plan", "b.plan"}) {
    EXPECT_THAT(run({"plan", "save", burley, "--size", "640x360", "--out", path(file)}),
                Succeeds("passes"));
  }
  EXPECT_EQ(read_text(path("a.plan")), read_text(path("b.plan")));
  EXPECT_THAT(files(), ElementsAre("a.plan", "b.plan"));
  EXPECT_THAT(run({"plan", "verify", path("a.plan")}), Succeeds("no hazard"));
  const Outcome json = run({"plan", "save", burley, "--json", "--out", path("c.plan")});
  EXPECT_TRUE(is_json(json.out)) << json.out;
  EXPECT_THAT(json.out, HasSubstr("\"sha256\""));
  EXPECT_EQ(run({"plan", "save", path("a.plan"), "--out", path("d.plan")}).exit_code, 2);
  EXPECT_EQ(run({"plan", "save", burley}).exit_code, 2) << "no --out";
  EXPECT_EQ(run({"plan", "save", burley, "--out", path("no/such/folder/a.plan")}).exit_code, 3);
}

TEST_F(PlanFiles, AsyncPasses_GetAQueueOnRequest) {
  const std::string graph = write("two.json", R"({ "dermis": 2, "name": "two",
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "resources": { "a": { "format": "rgba16f", "size": "view" }, "b": { "format": "rgba16f", "size": "view/2" },
    "out": { "format": "rgba16f", "size": "view/4" } },
  "passes": [
    { "pass": "first", "type": "subsurface.pyramid_down", "read": { "fine": "light" }, "write": { "coarse": "a" } },
    { "pass": "aside", "type": "subsurface.pyramid_down", "queue": "async", "read": { "fine": "a" }, "write": { "coarse": "b" } },
    { "pass": "last", "type": "subsurface.pyramid_down", "read": { "fine": "b" }, "write": { "coarse": "out" } } ],
  "exports": ["out"] })");
  const Outcome one = run({"explain", graph}), two = run({"explain", graph, "--two-queues"});
  EXPECT_EQ(two.exit_code, 0) << two.err;
  EXPECT_THAT(one.out, Not(HasSubstr("async queue")));
  EXPECT_THAT(two.out,
              HasAll("aside (subsurface.pyramid_down) on the async queue",
                     "the main queue signals point 1", "waits for point 1 of the async queue"));
  ASSERT_EQ(run({"plan", "save", graph, "--two-queues", "--out", path("two.plan")}).exit_code, 0);
  EXPECT_THAT(run({"plan", "verify", path("two.plan")}).out, HasSubstr("no hazard"));
  EXPECT_THAT(run({"plan", "diff", path("two.plan"), graph}).out, HasSubstr("single queue"));
}

TEST_F(PlanFiles, ADamagedPlanIsRejectedWithTheByte) {
  ASSERT_EQ(run({"plan", "save", burley, "--out", path("a.plan")}).exit_code, 0);
  const std::string whole = read_text(path("a.plan"));
  const std::string cut = write("cut.plan", whole.substr(0, whole.size() - 9));
  EXPECT_THAT(run({"plan", "verify", cut}),
              FailsWith(1, "cut.plan", "D0321 plan_file", "byte ", "the file ends inside"));
  EXPECT_EQ(run({"plan", "diff", cut, burley}).exit_code, 1);
  EXPECT_THAT(run({"plan", "verify", burley}).err,
              HasSubstr("a saved plan must begin with DERMPLAN"));
  EXPECT_THAT(run({"plan", "verify", path("none.plan")}).err, HasSubstr("does not exist"));
  EXPECT_TRUE(is_json(run({"plan", "verify", cut, "--json"}).out));
  EXPECT_THAT(run({"validate", cut}), FailsWith(1, "cut.plan", "D0321 plan_file", "byte "));
}

TEST_F(PlanFiles, VerifiedPlans_AreListedAsJson) {
  ASSERT_EQ(run({"plan", "save", burley, "--out", path("a.plan")}).exit_code, 0);
  const std::string bad = write("bad.plan", "DERMPLAN");
  const Outcome good = run({"plan", "verify", path("a.plan"), "--json"});
  EXPECT_TRUE(is_json(good.out)) << good.out;
  EXPECT_THAT(good.out, HasAll("\"ok\": true", "\"passes\": ", "\"barriers\": "));
  const Outcome mixed = run({"plan", "verify", path("a.plan"), bad, "--json"});
  EXPECT_EQ(mixed.exit_code, 1);
  EXPECT_TRUE(is_json(mixed.out)) << mixed.out;
  EXPECT_THAT(mixed.out, HasAll("\"ok\": false", "\"ok\": true", "bad.plan", "plan_file"));
  EXPECT_THAT(run({"validate", path("a.plan")}), Succeeds("plan, no problems"));
}

// Clears the stages that the first barrier waits for; their bytes are found by comparison.
TEST_F(PlanFiles, PlanWithAHazard_NamesPassAndResource) {
  ASSERT_EQ(run({"plan", "save", burley, "--out", path("a.plan")}).exit_code, 0);
  const std::string whole = read_text(path("a.plan"));
  // Every barrier from compute to compute contains these 16 bytes: source and destination stages.
  const std::string stages("\0\x08\0\0\0\0\0\0\0\x08\0\0\0\0\0\0", 16);
  const size_t at = whole.find(stages);
  ASSERT_NE(at, std::string::npos);
  std::string bad = whole;
  bad[at + 1] = '\0';
  EXPECT_THAT(run({"plan", "verify", write("bad.plan", bad)}),
              FailsWith(1, "D0322 plan_rejected", "is '"));
}

// Seventeen images with a million subresources together, which no graph can have.
TEST_F(PlanFiles, TooLargePlan_IsNotVerified) {
  ASSERT_EQ(run({"plan", "save", burley, "--out", path("a.plan")}).exit_code, 0);
  Diagnostics diagnostics;
  std::optional<SavedPlan> saved = read_plan("a.plan", read_text(path("a.plan")), diagnostics);
  ASSERT_TRUE(saved);
  Plan& plan = saved->plan;
  for (uint32_t i = 0; i < 17; ++i) {
    PlanResource image;
    image.mips = 31;
    image.layers = 2048;
    image.first_instance = static_cast<uint32_t>(plan.placements.size());
    const auto resource = static_cast<uint32_t>(plan.resources.size());
    plan.placements.push_back({resource, static_cast<uint32_t>(plan.heaps.size()), 0, 64, 64});
    plan.heaps.push_back({0xffffffffu, 64, 64});
    plan.resources.push_back(image);
    saved->names.resources.push_back("image");
    for (uint16_t layer = 0; layer < 2048; ++layer) {
      ++plan.final_barrier_count;
      PlanBarrier& barrier = plan.barriers.emplace_back();
      barrier.resource = resource;
      barrier.range = {static_cast<uint16_t>(layer % 31), 1, layer, 1};
    }
  }
  const std::string file = write("large.plan", write_plan(*saved));
  const Outcome outcome = run({"plan", "verify", file});
  EXPECT_THAT(outcome, FailsWith(1, "D0327 plan_not_verified", "the plan is not verified",
                                 Not(HasSubstr("defect")), Not(HasSubstr("report"))));
  EXPECT_THAT(outcome.out, IsEmpty());
}

TEST_F(PlanFiles, GraphEqualsItsSavedPlan) {
  ASSERT_EQ(run({"plan", "save", burley, "--out", path("a.plan")}).exit_code, 0);
  EXPECT_THAT(run({"plan", "diff", path("a.plan"), burley, "--exit-code"}),
              Succeeds("the plans are the same", Not(HasSubstr("barriers\n"))));
}

TEST_F(PlanFiles, GraphsDifferByTheirOwnPasses) {
  const Outcome diff = run({"plan", "diff", burley, "configs/graphs/separable.json"});
  EXPECT_THAT(diff, Succeeds("the plans differ", "- scatter: subsurface.burley", "+ ",
                             "subsurface.separable", "totals"))
      << "differences are not a failure unless requested";
  EXPECT_EQ(run({"plan", "diff", burley, "configs/graphs/separable.json", "--exit-code"}).exit_code,
            1);
  const Outcome json = run({"plan", "diff", burley, "configs/graphs/separable.json", "--json"});
  EXPECT_TRUE(is_json(json.out)) << json.out;
  EXPECT_THAT(json.out, HasSubstr("\"same\": false"));
  EXPECT_THAT(json.err, IsEmpty());
}

TEST_F(PlanFiles, OneGraphWithTwoSetsOfOptions) {
  EXPECT_THAT(run({"plan", "diff", burley, "--b-size", "960x540"}),
              Succeeds("~ view: 1920x1080 -> 960x540", "transients "));
  const Outcome set = run({"plan", "diff", burley, "--set", "samples=16", "--b-set", "samples=8"});
  EXPECT_THAT(set.out, HasSubstr("~ samples: 16 -> 8"));
  const Outcome overlay = run({"plan", "diff", burley, "--b-overlay",
                               "configs/overlays/full_precision.json", "--exit-code"});
  EXPECT_EQ(overlay.exit_code, 1) << overlay.err;
  EXPECT_THAT(overlay.out, HasSubstr("rgba32f"));
  const Outcome slot = run({"plan", "diff", burley, "--b-unbound", "scatter_scale", "--exit-code"});
  EXPECT_EQ(slot.exit_code, 1) << slot.err;
  EXPECT_THAT(slot.out, HasSubstr("unbound slots: none -> scatter_scale"));
}

TEST_F(PlanFiles, IncomparableFilesAreAUsageError) {
  EXPECT_THAT(run({"plan", "diff", burley}).err, HasSubstr("name two plans"));
  ASSERT_EQ(run({"plan", "save", burley, "--out", path("a.plan")}).exit_code, 0);
  EXPECT_THAT(run({"plan", "diff", burley, path("a.plan"), "--b-set", "samples=8"}),
              FailsWith(2, "is a saved plan"));
  EXPECT_THAT(run({"plan", "diff", burley, "--b-set", "sample=8"}),
              FailsWith(2, "did you mean 'samples'?"));
}

} // namespace
} // namespace dermis::test
