// Tests the difference of two plans: empty for equal plans, symmetric, and with a line that names
// each change.

#include "framegraph/explain/plan_diff.hpp"
#include "framegraph/text/document.hpp"
#include "tests/framegraph/random_graph.hpp"
#include "tests/framegraph/saved_graph.hpp"
#include "tests/support/matchers.hpp"

#include <algorithm>
#include <functional>
#include <tuple>

namespace dermis::testing {
namespace {

const PlanDiffSection& section(const PlanDiff& diff, std::string_view name) {
  static const PlanDiffSection none;
  for (const PlanDiffSection& one : diff.sections)
    if (one.name == name) return one;
  ADD_FAILURE() << name;
  return none;
}

using Line = std::tuple<std::string, std::string, std::string>; // Name, a, b.

std::vector<Line> lines(const PlanDiffSection& of, bool turned) {
  std::vector<Line> out;
  for (const PlanDifference& one : of.differences)
    out.emplace_back(one.name, turned ? one.b : one.a, turned ? one.a : one.b);
  std::sort(out.begin(), out.end());
  return out;
}

bool is_json(const std::string& text) {
  Diagnostics diagnostics;
  return parse_document("diff", text, diagnostics).has_value();
}

TEST(PlanDiff, EqualPlans_GiveAnEmptyDiff) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const GraphBuilder builder = random_graph(seed);
    const SavedPlan plan = saved(builder.input());
    const PlanDiff diff = diff_plans(plan, plan);
    EXPECT_TRUE(diff.same);
    for (const PlanDiffSection& one : diff.sections)
      EXPECT_THAT(one.differences, IsEmpty()) << one.name;
    EXPECT_THAT(plan_diff_text(diff, "one", "two"),
                HasAll("A: one\nB: two\nthe plans are the same\n", "\ntotals\n"));
    EXPECT_TRUE(is_json(plan_diff_json(diff, "one", "two")));
  }
}

TEST(PlanDiff, IsSymmetric) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const GraphBuilder first = random_graph(seed), second = random_graph(seed + 1);
    CompileInput fast = first.input();
    fast.packing = PackingLevel::fast;
    fast.alias = false;
    const SavedPlan a = saved(first.input());
    for (const SavedPlan& b : {saved(second.input()), saved(fast)}) {
      const PlanDiff there = diff_plans(a, b), back = diff_plans(b, a);
      EXPECT_EQ(there.same, back.same);
      ASSERT_EQ(there.sections.size(), back.sections.size());
      for (size_t s = 0; s < there.sections.size(); ++s)
        // Either of two swapped passes may be reported as moved.
        if (there.sections[s].name != "order") {
          EXPECT_EQ(lines(there.sections[s], false), lines(back.sections[s], true))
              << there.sections[s].name;
        }
      EXPECT_EQ(section(there, "order").differences.size(),
                section(back, "order").differences.size());
      EXPECT_TRUE(is_json(plan_diff_json(there, "a", "b")));
    }
  }
}

GraphBuilder sample() {
  GraphBuilder b;
  b.boolean("smooth", true);
  b.import("light");
  b.import("shade").optional = true;
  b.history("sum");
  b.image("lit");
  b.exported("result");
  b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", "sum@-1"}}, {{"out", "sum"}}).when =
      b.when("smooth");
  b.pass("mix", "test.shade", {{"a", "sum"}, {"b", "shade"}}, {{"out", "lit"}});
  b.pass("show", "test.need", {{"a", "lit"}}, {{"out", "result"}});
  return b;
}

struct Change {
  const char* section;
  const char* name;
  std::function<void(SavedPlan&)> apply;
};

TEST(PlanDiff, NamesEachChange) {
  const GraphBuilder builder = sample();
  const SavedPlan plan = saved(builder.input());
  const uint32_t lit = [&] {
    for (uint32_t r = 0; r < plan.names.resources.size(); ++r)
      if (plan.names.resources[r] == "lit") return r;
    return UINT32_MAX;
  }();
  ASSERT_LT(lit, plan.plan.resources.size());
  const Change changes[] = {
      {"compiled_from", "graph", [](auto& p) { p.key.graph[0] ^= 1; }},
      {"compiled_from", "view", [](auto& p) { ++p.key.view_width; }},
      {"compiled_from", "pixel grid", [](auto& p) { ++p.key.pixel_grid; }},
      {"compiled_from", "device", [](auto& p) { p.key.device_profile = "another"; }},
      {"compiled_from", "device limits", [](auto& p) { p.key.buffer_image_granularity = 7; }},
      {"compiled_from", "device features",
       [](auto& p) { p.key.features ^= bit_of(Feature::ray_query); }},
      {"compiled_from", "unbound slots", [](auto& p) { p.key.bound[1] = 0; }},
      {"compiled_from", "host formats", [](auto& p) { p.key.host_formats[0] = Format::r32f; }},
      {"compiled_from", "order", [](auto& p) { p.key.order = PassOrder::random; }},
      {"compiled_from", "packing", [](auto& p) { p.key.packing = PackingLevel::optimize; }},
      {"compiled_from", "aliasing", [](auto& p) { p.key.alias = false; }},
      {"compiled_from", "culling", [](auto& p) { p.key.cull = false; }},
      {"compiled_from", "poison", [](auto& p) { p.key.poison = true; }},
      {"compiled_from", "single queue", [](auto& p) { p.key.single_queue = false; }},
      {"compiled_from", "kept alive", [](auto& p) { p.key.keep_alive = ResourceId{1}; }},
      {"settings", "smooth", [](auto& p) { p.names.settings[0].text = "false"; }},
      {"passes", "mix", [](auto& p) { p.names.pass_types[1] = "test.other"; }},
      {"passes", "mix", [](auto& p) { p.plan.passes[1].queue = Queue::async; }},
      {"passes", "mix", [](auto& p) { p.plan.passes[1].wait = 3; }},
      {"passes", "mix", [](auto& p) { p.plan.passes[1].signal = 3; }},
      {"passes", "show",
       [](auto& p) {
         p.plan.orderings.push_back({0, 2});
       }},
      {"passes", "show", [](auto& p) { p.names.passes[2] = "hide"; }},
      {"resources", "lit", [=](auto& p) { ++p.plan.resources[lit].width; }},
      {"resources", "lit", [=](auto& p) { p.plan.resources[lit].format = Format::r32f; }},
      {"placements", "lit",
       [=](auto& p) { p.plan.placements[p.plan.resources[lit].first_instance].offset += 64; }},
      {"placements", "lit",
       [=](auto& p) { p.plan.placements[p.plan.resources[lit].first_instance].persistent = true; }},
      {"histories", "sum", [](auto& p) { ++p.plan.histories[0].frames; }},
      {"histories", "sum",
       [](auto& p) { p.plan.histories[0].declaration.first = HistoryDeclaration::First::clear; }},
      {"histories", "sum",
       [](auto& p) { p.plan.histories[0].declaration.on_cut = HistoryDeclaration::OnCut::keep; }},
      {"histories", "sum",
       [](auto& p) {
         p.plan.histories[0].declaration.on_resize = HistoryDeclaration::OnResize::rescale;
       }},
      {"heaps", "heap 0", [](auto& p) { ++p.plan.heaps[0].size; }},
      {"heaps", "heap 0", [](auto& p) { p.plan.heaps[0].memory_type_bits ^= 2; }},
      {"heaps", "heap 0", [](auto& p) { p.plan.heaps[0].alignment = 3; }},
      {"heaps", "heap 0", [](auto& p) { p.plan.heaps[0].max_live_bytes = 3; }},
      {"heaps", "heap 0", [](auto& p) { p.plan.heaps[0].persistent ^= true; }},
      {"heaps", "heap 9", [](auto& p) { p.plan.heaps.resize(10); }},
      {"barriers", "before show: lit",
       [](auto& p) { p.plan.barriers[p.plan.passes[2].first_barrier].source_stages = 0; }},
  };
  for (const Change& change : changes) {
    SavedPlan changed = plan;
    change.apply(changed);
    const PlanDiff diff = diff_plans(plan, changed);
    const auto& found = section(diff, change.section).differences;
    EXPECT_TRUE(std::any_of(found.begin(), found.end(),
                            [&](const PlanDifference& one) { return one.name == change.name; }))
        << change.section << ": " << change.name << '\n'
        << plan_diff_text(diff, "a", "b");
    const bool in_key = std::string_view(change.section) == "compiled_from";
    EXPECT_EQ(diff.same, in_key) << change.section << ": " << change.name;
    EXPECT_THAT(plan_diff_text(diff, "a", "b"), HasSubstr(change.name));
  }
}

TEST(PlanDiff, SettingReplacedByItsValueIsADifference) {
  const GraphBuilder builder = sample();
  SavedPlan plan = saved(builder.input());
  plan.names.pass_settings.push_back({"round", "true"}); // of the last pass
  plan.plan.settings.push_back({SettingId{0}, plan.plan.setting_values[0]});
  SavedPlan literal = plan;
  literal.plan.settings[0].from = {};
  const PlanDiff diff = diff_plans(plan, literal);
  EXPECT_FALSE(diff.same);
  const auto& found = section(diff, "passes").differences;
  ASSERT_EQ(found.size(), 1u) << plan_diff_text(diff, "a", "b");
  EXPECT_THAT(found[0].a, HasSubstr(" round=$smooth=true"));
  EXPECT_THAT(found[0].b, HasSubstr(" round=true"));
}

TEST(PlanDiff, ReportsTheFewestMovedPasses) {
  const GraphBuilder builder = sample();
  const SavedPlan plan = saved(builder.input());
  SavedPlan turned = plan;
  std::rotate(turned.names.passes.begin(), turned.names.passes.begin() + 1,
              turned.names.passes.end());
  const PlanDiff diff = diff_plans(plan, turned);
  const auto& moved = section(diff, "order").differences;
  ASSERT_EQ(moved.size(), 1u) << plan_diff_text(diff, "a", "b");
  EXPECT_EQ(moved[0].name, "accumulate");
  EXPECT_EQ(moved[0].a, "position 0");
  EXPECT_EQ(moved[0].b, "position 2");
}

} // namespace
} // namespace dermis::testing
