// Cached plans equal compiled plans, and different inputs never have equal keys.

#include "framegraph/serialize/plan_cache.hpp"
#include "framegraph/serialize/plan_file.hpp"
#include "tests/framegraph/random_graph.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

std::string bytes(const std::optional<CompiledPlan>& compiled) {
  return compiled ? plan_bytes(compiled->plan) : "none";
}

TEST(PlanCache, HasTheBytesAndReasonsOfCompiling) {
  for (uint64_t seed = 0; seed < 100; ++seed) {
    const GraphBuilder builder = random_graph(seed);
    PlanCache cache;
    Diagnostics diagnostics;
    const auto fresh = compile(builder.input(), diagnostics);
    const auto first = compile(builder.input(), cache, diagnostics);
    const auto again = compile(builder.input(), cache, diagnostics);
    EXPECT_EQ(bytes(first), bytes(fresh));
    EXPECT_EQ(bytes(again), bytes(fresh));
    ASSERT_TRUE(fresh && again);
    EXPECT_EQ(again->reasons.size(), fresh->reasons.size());
    EXPECT_EQ(cache.hits, 1u);
    EXPECT_EQ(cache.misses, 1u);
  }
}

TEST(PlanCache, TogglingASetting_CompilesOncePerValue) {
  GraphBuilder builder = random_graph(8);
  builder.boolean("flag", true);
  PlanCache cache;
  Diagnostics diagnostics;
  for (uint32_t i = 0; i < 10; ++i) {
    CompileInput input = builder.input();
    for (const SettingDeclaration& setting : builder.graph.settings)
      input.settings.push_back(setting.default_value);
    input.settings.back().integer = i % 2;
    const auto plan = compile(input, cache, diagnostics);
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->plan.setting_values.back().integer, i % 2);
    EXPECT_EQ(bytes(plan), bytes(compile(input, diagnostics)));
  }
  EXPECT_EQ(cache.misses, 2u);
  EXPECT_EQ(cache.hits, 8u);
}

TEST(PlanCache, DifferentInputs_NeverShareAPlan) {
  const GraphBuilder builder = random_graph(8), other = random_graph(9);
  PlanCache cache;
  Diagnostics diagnostics;
  EXPECT_EQ(bytes(compile(builder.input(), cache, diagnostics)),
            bytes(compile(builder.input(), diagnostics)));
  EXPECT_EQ(bytes(compile(other.input(), cache, diagnostics)),
            bytes(compile(other.input(), diagnostics)));
  EXPECT_EQ(bytes(compile(builder.input(65, 64), cache, diagnostics)),
            bytes(compile(builder.input(65, 64), diagnostics)));
  EXPECT_EQ(cache.hits, 0u);
}

TEST(PlanCache, Full_EvictsTheLeastRecentlyUsedPlan) {
  const GraphBuilder builder = random_graph(8);
  PlanCache cache;
  Diagnostics diagnostics;
  const auto use = [&](size_t width) {
    const uint64_t hits = cache.hits;
    EXPECT_TRUE(compile(builder.input(static_cast<uint32_t>(width)), cache, diagnostics));
    return cache.hits > hits;
  };
  for (size_t i = 0; i < plan_cache_capacity; ++i)
    EXPECT_FALSE(use(64 + i));
  EXPECT_TRUE(use(64)) << "now the most recently used plan";
  EXPECT_FALSE(use(200)) << "evicts 65";
  EXPECT_EQ(cache.entries.size(), plan_cache_capacity);
  EXPECT_TRUE(use(64));
  EXPECT_FALSE(use(65));
}

TEST(PlanCache, FailedCompilation_IsNotCached) {
  const GraphBuilder builder = random_graph(8);
  PlanCache cache;
  for (uint32_t i = 0; i < 2; ++i) {
    Diagnostics diagnostics;
    EXPECT_FALSE(compile(builder.input(0, 0), cache, diagnostics));
    EXPECT_TRUE(diagnostics.has_errors());
  }
  EXPECT_TRUE(cache.entries.empty());
}

} // namespace
} // namespace dermis::testing
