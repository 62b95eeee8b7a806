#include "passes/choice/calibration.hpp"
#include "passes/choice/cost_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace dermis;
using namespace dermis::choice;

// Models a device whose passes take 0.05 ms and 20 us per 100 groups.
double reference_ms(uint64_t groups) {
  return 0.05 + 0.0002 * static_cast<double>(groups);
}

TEST(CostModel, FindsBaseAndSlopeOfADevice) {
  CostModel model;
  const CostId id = model.add("work");
  for (uint64_t frame = 0; frame < 60; ++frame) {
    const uint64_t groups = 100 + frame * 97 % 3000;
    model.observe(id, groups, reference_ms(groups));
  }
  for (const uint64_t groups : {200u, 1000u, 3000u})
    EXPECT_NEAR(model.estimate(id, groups).ms, reference_ms(groups),
                0.03 * reference_ms(groups)); // The prior of 0 pulls the estimate down.
  EXPECT_TRUE(model.estimate(id, 1).measured);
}

TEST(CostModel, OutlierInOneOfEightFramesHasLittleEffect) {
  CostModel model;
  const CostId id = model.add("work");
  for (uint64_t frame = 0; frame < 200; ++frame) {
    const uint64_t groups = 100 + frame * 97 % 3000;
    model.observe(id, groups, reference_ms(groups) * (frame % 8 == 7 ? 5 : 1));
  }
  // Least squares would follow the mean, 1.5 times the real time.
  EXPECT_NEAR(model.estimate(id, 1500).ms, reference_ms(1500), 0.2 * reference_ms(1500));
}

TEST(CostModel, FollowsADeviceThatBecameSlower) {
  CostModel model;
  const CostId id = model.add("work");
  for (int frame = 0; frame < 100; ++frame)
    model.observe(id, 1000, 1.0);
  for (int frame = 0; frame < 100; ++frame)
    model.observe(id, 1000, 2.0);
  EXPECT_NEAR(model.estimate(id, 1000).ms, 2.0, 0.1);
}

TEST(CostModel, UnmeasuredWork_IsScaledLikeTheCalibration) {
  CostModel model({{"a", 10, 1, 0.1}, {"b", 20, 2, 0.1}});
  const CostId a = model.add("a"), b = model.add("b");
  EXPECT_NEAR(model.estimate(b, 1000).ms, 2.02, 1e-9);
  EXPECT_FALSE(model.estimate(b, 1000).measured);
  for (int frame = 0; frame < 50; ++frame)
    model.observe(a, 1000, 3 * 1.01); // This device is three times slower.
  EXPECT_NEAR(model.estimate(b, 1000).ms, 3 * 2.02, 0.01);
}

TEST(CostModel, GuessFromSimilarWork_DoesNotScaleTheRest) {
  CostModel model({{"known a", 100, 1, 0.1}});
  const CostId known = model.add("known a"), strange = model.add("strange");
  for (int i = 0; i < 40; ++i)
    model.observe(strange, 1000, 0.001); // The guess taken from similar work is 1.1 ms.
  EXPECT_NEAR(model.estimate(known, 1000).ms, 1.1, 1e-3);
}

TEST(CostModel, GuessFromAGuess_DoesNotScaleTheRest) {
  CostModel model({{"known a", 100, 1, 0.1}});
  const CostId known = model.add("known a");
  const CostId strange[] = {model.add("strange level=2"), model.add("strange level=3")};
  for (int i = 0; i < 40; ++i)
    for (const CostId one : strange)
      model.observe(one, 1000, 0.001);
  EXPECT_NEAR(model.estimate(known, 1000).ms, 1.1, 1e-3);
}

TEST(CostModel, UnknownWork_CostsLikeSimilarWorkAndNeverZero) {
  CostModel model({{"fixed inverse=exact samples=16", 10, 1, 0.1},
                   {"fixed inverse=approximate samples=8", 10, 4, 0.1},
                   {"heavy", 10, 9, 0.1}});
  EXPECT_NEAR(model.estimate(model.add("fixed inverse=exact samples=12"), 1000).ms, 1.01, 1e-9);
  EXPECT_NEAR(model.estimate(model.add("never heard of"), 1000).ms, 9.01, 1e-9);
}

TEST(CostModel, CoefficientsAreNeverNegative) {
  CostModel model;
  const CostId id = model.add("work");
  for (uint64_t frame = 0; frame < 20; ++frame)
    // Faster with more groups: noise.
    model.observe(id, 100 * frame, 2.0 - 0.05 * static_cast<double>(frame));
  EXPECT_GE(model.estimate(id, 0).ms, 0);
  EXPECT_GE(model.estimate(id, 1u << 20).ms, model.estimate(id, 0).ms);
}

TEST(CostModel, InvalidTimes_AreIgnored) {
  CostModel model;
  const CostId id = model.add("work");
  model.observe(id, 100, 1.0);
  const double before = model.estimate(id, 100).ms;
  for (const double bad : {std::nan(""), double(INFINITY), -1.0})
    model.observe(id, 100, bad);
  EXPECT_EQ(model.estimate(id, 100).ms, before);
}

TEST(Calibration, ReadsBackFromItsFile) {
  CostModel model;
  const CostId b = model.add("b"), a = model.add("a");
  model.add("never run");
  for (uint64_t groups = 100; groups < 2000; groups += 100) {
    model.observe(a, groups, reference_ms(groups));
    model.observe(b, groups, 2 * reference_ms(groups));
  }
  const Calibration out{"a device", model.calibration()};
  ASSERT_EQ(out.costs.size(), 2u);
  EXPECT_EQ(out.costs[0].work, "a"); // Sorted by name.
  const std::string text = write_calibration(out);
  Diagnostics diagnostics;
  const auto document = parse_document("calibration.json", text, diagnostics);
  ASSERT_TRUE(document);
  const auto back = read_calibration(*document, diagnostics);
  ASSERT_TRUE(back) << format_as_json(diagnostics);
  EXPECT_EQ(write_calibration(*back), text);
  CostModel again(back->costs);
  EXPECT_NEAR(again.estimate(again.add("a"), 500).ms, model.estimate(a, 500).ms, 1e-9);
}

TEST(Calibration, InvalidEntries_AreRejectedWithTheirPlace) {
  Diagnostics diagnostics;
  const auto document =
      parse_document("c.json",
                     "{\"dermis_calibration\": 2, \"device\": \"d\", \"costs\": [\n"
                     "{\"work\": \"w\", \"base_us\": -1, \"group_us\": 0, \"spred\": 0}]}",
                     diagnostics);
  ASSERT_TRUE(document);
  EXPECT_FALSE(read_calibration(*document, diagnostics));
  ASSERT_EQ(diagnostics.count(Severity::error), 2u) << format_as_json(diagnostics);
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::out_of_range);
  EXPECT_EQ(diagnostics.list[0].where.pointer, "/costs/0/base_us");
  EXPECT_EQ(diagnostics.list[1].id, DiagnosticId::unknown_key);
  EXPECT_EQ(diagnostics.list[1].where.line, 2u);
}

} // namespace
