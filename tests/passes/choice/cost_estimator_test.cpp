#include "passes/choice/calibration.hpp"
#include "passes/choice/cost_estimator.hpp"
#include "passes/choice/time_margin.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace dermis;
using namespace dermis::choice;

constexpr double frame_s = 1.0 / 60;

// Adds `frames` frames of the passes, from `clock_s` on.
void observe(CostEstimator& costs, const std::vector<PassTime>& passes, int frames,
             double& clock_s) {
  for (int i = 0; i < frames; ++i) {
    clock_s += frame_s;
    costs.observe(passes, clock_s);
  }
}

double expected_ms(CostEstimator& costs, CostId id, uint64_t groups, double clock_s) {
  return costs.predict(clock_s)[id.value].expected *
         costs.calibrated_cost(id).ms(static_cast<double>(groups));
}

TEST(CostEstimator, FollowsADeviceThatBecameSlower) {
  CostEstimator costs({{"a", 10, 1, 0.1}, {"b", 20, 2, 0.1}});
  const CostId a = costs.add("a"), b = costs.add("b");
  double clock_s = 0;
  observe(costs, {{a, 1000, 1.01}, {b, 1000, 2.02}}, 100, clock_s);
  EXPECT_NEAR(expected_ms(costs, a, 1000, clock_s), 1.01, 0.01);
  observe(costs, {{a, 1000, 2.02}, {b, 1000, 4.04}}, 3, clock_s);
  EXPECT_NEAR(expected_ms(costs, a, 1000, clock_s), 2.02, 0.1) << "a step within three frames";
}

TEST(CostEstimator, SingleLongFrame_ChangesLittle) {
  CostEstimator costs({{"a", 10, 1, 0.1}});
  const CostId a = costs.add("a");
  double clock_s = 0;
  observe(costs, {{a, 1000, 1.01}}, 100, clock_s);
  observe(costs, {{a, 1000, 10.1}}, 1, clock_s);
  EXPECT_NEAR(expected_ms(costs, a, 1000, clock_s), 1.01, 0.02);
}

// Passes that do not run follow the factor that all passes share.
TEST(CostEstimator, AbsentWork_FollowsTheDevice) {
  CostEstimator costs({{"shared", 10, 1, 0.1}, {"one", 10, 1, 0.1}, {"other", 10, 1, 0.1}});
  const CostId shared = costs.add("shared"), one = costs.add("one"), other = costs.add("other");
  double clock_s = 0;
  observe(costs, {{shared, 1000, 1.01}, {one, 1000, 1.01}}, 100, clock_s);
  observe(costs, {{shared, 1000, 1.01}, {other, 1000, 1.01}}, 100, clock_s);
  observe(costs, {{shared, 1000, 2.02}, {other, 1000, 2.02}}, 30, clock_s);
  EXPECT_NEAR(expected_ms(costs, one, 1000, clock_s), 2.02, 0.1);
  observe(costs, {{shared, 1000, 1.01}, {other, 1000, 1.01}}, 100, clock_s);
  EXPECT_NEAR(expected_ms(costs, one, 1000, clock_s), 1.01, 0.05) << "no ratchet";
}

TEST(CostEstimator, DisturbedWork_KeepsItsUsualTimeInMind) {
  CostEstimator costs({{"shared", 10, 1, 0.1}, {"one", 10, 1, 0.1}});
  const CostId shared = costs.add("shared"), one = costs.add("one");
  double clock_s = 0;
  observe(costs, {{shared, 1000, 1.01}, {one, 1000, 1.01}}, 100, clock_s);
  observe(costs, {{shared, 1000, 1.01}, {one, 1000, 3.03}}, 20, clock_s); // only this pass
  observe(costs, {{shared, 1000, 1.01}}, 60, clock_s);
  const CostFactors factors = costs.predict(clock_s)[one.value];
  EXPECT_GT(factors.expected, 2); // a part of the excess went to the device
  EXPECT_LT(factors.expected, 3.1);
  EXPECT_NEAR(factors.undisturbed, 1, 0.2);
  EXPECT_FALSE(factors.measured);
  // The first time after a break counts fully.
  observe(costs, {{shared, 1000, 1.01}, {one, 1000, 1.01}}, 3, clock_s);
  EXPECT_NEAR(costs.predict(clock_s)[one.value].expected, 1, 0.1);
}

TEST(CostEstimator, UnmeasuredWork_IsScaledTowardsTheOthers) {
  CostEstimator costs({{"a", 10, 1, 0.1}, {"b", 10, 1, 0.1}, {"c", 20, 2, 0.1}});
  const CostId a = costs.add("a"), b = costs.add("b"), c = costs.add("c");
  EXPECT_NEAR(expected_ms(costs, c, 1000, 0), 2.02, 1e-9);
  double clock_s = 0;
  // Both passes take three times their calibrated time, which may be the device or the calibration.
  observe(costs, {{a, 1000, 3.03}, {b, 1000, 3.03}}, 50, clock_s);
  EXPECT_NEAR(expected_ms(costs, c, 1000, clock_s), 2.02 * std::pow(3, 2.0 / 3), 0.05);
  const CostFactors factors = costs.predict(clock_s)[c.value];
  EXPECT_LT(factors.optimistic, 1.0 / 3);
  EXPECT_GT(factors.pessimistic, 3);
}

TEST(CostEstimator, Uncertainty_SetsTheRangeOfUnmeasuredWork) {
  CostEstimator costs({{"a", 10, 1, 0.1}, {"b", 10, 1, 0.1}}, 1);
  const CostId a = costs.add("a"), b = costs.add("b");
  double clock_s = 0;
  observe(costs, {{a, 1000, 1.01}}, 50, clock_s);
  EXPECT_NEAR(costs.predict(clock_s)[b.value].optimistic, 1, 1e-3);
  EXPECT_NEAR(costs.predict(clock_s)[b.value].pessimistic, 1, 1e-3);
  costs.set_uncertainty(8);
  EXPECT_NEAR(costs.predict(clock_s)[b.value].optimistic, 1.0 / 8, 1e-3);
  EXPECT_NEAR(costs.predict(clock_s)[b.value].pessimistic, 2, 1e-3); // the cubic root
}

// A calibration contains costs that were measured, and others that the library only assumes.
TEST(CostEstimator, CostsMayStateTheirOwnUncertainty) {
  CostEstimator costs({{"a", 10, 1, 0.1}, {"b", 10, 1, 0.1, 2}, {"c", 10, 1, 0.1}}, 4);
  const CostId a = costs.add("a"), b = costs.add("b"), c = costs.add("c");
  double clock_s = 0;
  observe(costs, {{a, 1000, 1.01}}, 50, clock_s);
  const auto optimistic = [&](CostId id) { return costs.predict(clock_s)[id.value].optimistic; };
  EXPECT_NEAR(optimistic(b), 1.0 / 2, 1e-3);
  EXPECT_NEAR(optimistic(c), 1.0 / 4, 1e-3);
  costs.set_uncertainty(8, true); // by the host
  EXPECT_NEAR(optimistic(b), 1.0 / 8, 1e-3);
  const std::vector<Cost> exported = costs.calibration();
  ASSERT_EQ(exported.size(), 3u);
  EXPECT_EQ(exported[0].uncertainty, same_device_uncertainty);
  EXPECT_EQ(exported[1].uncertainty, 2);
  EXPECT_EQ(exported[2].uncertainty, 0);
}

// After half an hour, work that does not run may have become cheaper.
TEST(CostEstimator, UnseenWork_BecomesUncertain) {
  CostEstimator costs({{"shared", 10, 1, 0.1}, {"one", 10, 1, 0.1}});
  const CostId shared = costs.add("shared"), one = costs.add("one");
  double clock_s = 0;
  observe(costs, {{shared, 1000, 1.01}, {one, 1000, 1.01}}, 100, clock_s);
  clock_s += 1800;
  observe(costs, {{shared, 1000, 1.01}}, 1, clock_s);
  EXPECT_NEAR(costs.predict(clock_s)[one.value].undisturbed, std::exp(-0.2), 0.01);
}

TEST(CostEstimator, WithoutTimestamps_NothingIsOptimistic) {
  CostEstimator costs({{"a", 10, 1, 0.1}});
  const CostId a = costs.add("a");
  EXPECT_EQ(costs.predict(10)[a.value].optimistic, 1);
}

TEST(CostEstimator, RejectedWork_IsLessOptimistic) {
  CostEstimator costs({{"shared", 10, 1, 0.1}, {"one", 10, 1, 0.1}});
  const CostId shared = costs.add("shared"), one = costs.add("one");
  double clock_s = 0;
  observe(costs, {{shared, 1000, 1.01}, {one, 1000, 2.02}}, 5, clock_s); // tried
  observe(costs, {{shared, 1000, 1.01}}, 60, clock_s);
  const double before = costs.predict(clock_s)[one.value].undisturbed;
  costs.reduce_optimism(one);
  EXPECT_GT(costs.predict(clock_s)[one.value].undisturbed, 2 * before);
}

// With one frame in flight the first frame counts alone.
TEST(CostEstimator, SlowFirstFrame_IsNotUsual) {
  CostEstimator costs({{"shared", 10, 1, 0.1}, {"one", 10, 1, 0.1}});
  const CostId shared = costs.add("shared"), one = costs.add("one");
  double clock_s = 0;
  observe(costs, {{shared, 1000, 1.01}}, 60, clock_s);
  observe(costs, {{shared, 1000, 1.01}, {one, 1000, 3.03}}, 1, clock_s);
  costs.reduce_optimism(one);
  observe(costs, {{shared, 1000, 1.01}}, 120, clock_s);
  EXPECT_LT(costs.predict(clock_s)[one.value].undisturbed, 1);
}

// After a loading stall the first frame is the one most likely to be slow.
TEST(CostEstimator, SlowFrameAfterAPause_ChangesLittle) {
  CostEstimator costs({{"a", 10, 1, 0.1}, {"b", 10, 1, 0.1}});
  const CostId a = costs.add("a"), b = costs.add("b");
  double clock_s = 0;
  observe(costs, {{a, 1000, 1.01}, {b, 1000, 1.01}}, 100, clock_s);
  clock_s += 0.6;
  observe(costs, {{a, 1000, 3.03}, {b, 1000, 1.01}}, 1, clock_s);
  EXPECT_NEAR(expected_ms(costs, a, 1000, clock_s), 1.01, 0.05);
}

// Deterministic choices do not depend on the device.
TEST(CostEstimator, CalibratedCostOfANewSetting_IsNotMeasured) {
  CostEstimator costs({{"work samples=16", 10, 1, 0.1}});
  const CostId first = costs.add("work samples=16");
  double clock_s = 0;
  observe(costs, {{first, 1000, 2.02}}, 100, clock_s);
  const CostId other = costs.add("work samples=32");
  EXPECT_NEAR(expected_ms(costs, other, 1000, clock_s), 2.02, 0.05);
  EXPECT_DOUBLE_EQ(costs.calibrated_cost(other).ms(1000), costs.calibrated_cost(first).ms(1000));
}

TEST(CostEstimator, ManyWorks_ExportAReadableCalibration) {
  CostEstimator costs;
  std::vector<PassTime> once, often;
  for (size_t i = 0; i < max_calibrated_costs + 100; ++i)
    (i < 100 ? often : once).push_back({costs.add("work seed=" + std::to_string(i)), 1, 0.01});
  double clock_s = 0;
  observe(costs, once, 1, clock_s);
  observe(costs, often, 3, clock_s);
  const Calibration exported{"device", other_device_uncertainty, costs.calibration()};
  EXPECT_EQ(exported.costs.size(), max_calibrated_costs);
  EXPECT_EQ(std::ranges::count(exported.costs, "work seed=0", &Cost::work), 1);
  Diagnostics diagnostics;
  const auto document = parse_document("c.json", write_calibration(exported), diagnostics);
  EXPECT_TRUE(document && read_calibration(*document, diagnostics)) << format_as_json(diagnostics);
}

TEST(CostEstimator, RetiredWork_IsNotCounted) {
  CostEstimator costs;
  const CostId a = costs.add("a"), b = costs.add("b");
  EXPECT_EQ(costs.unmeasured(), 2u);
  costs.retire_all();
  EXPECT_EQ(costs.unmeasured(), 0u);
  costs.use(a);
  EXPECT_EQ(costs.unmeasured(), 1u);
  double clock_s = 0;
  observe(costs, {{b, 1000, 2.0}}, 100, clock_s); // A frame from before may still arrive.
  EXPECT_EQ(costs.add("b").value, b.value);
  EXPECT_NEAR(expected_ms(costs, b, 1000, clock_s), 2.0, 0.1) << "what was learned stays";
}

TEST(CostEstimator, EmptyDispatches_TeachNothing) {
  CostEstimator costs({{"samples", 0, 1, 0.1}, {"a", 10, 1, 0.1}});
  const CostId samples = costs.add("samples"), a = costs.add("a");
  double clock_s = 0;
  observe(costs, {{samples, 1000, 1}, {a, 1000, 1.01}}, 100, clock_s);
  observe(costs, {{samples, 0, 0.002}, {a, 1000, 1.01}}, 1000, clock_s);
  EXPECT_NEAR(expected_ms(costs, samples, 1000, clock_s), 1, 0.05);
}

TEST(CostEstimator, GuessFromSimilarWork_DoesNotScaleTheRest) {
  CostEstimator costs({{"known a", 100, 1, 0.1}});
  const CostId known = costs.add("known a");
  const CostId strange[] = {costs.add("strange level=2"), costs.add("strange level=3")};
  EXPECT_TRUE(costs.has_calibration(known));
  EXPECT_FALSE(costs.has_calibration(strange[0]));
  double clock_s = 0;
  // The guess taken from similar work is 1.1 ms.
  observe(costs, {{strange[0], 1000, 0.001}, {strange[1], 1000, 0.001}}, 40, clock_s);
  EXPECT_NEAR(expected_ms(costs, known, 1000, clock_s), 1.1, 1e-3);
}

TEST(CostEstimator, UnknownWork_CostsLikeSimilarWorkAndNever0) {
  CostEstimator costs({{"fixed inverse=exact samples=16", 10, 1, 0.1},
                       {"fixed inverse=approximate samples=8", 10, 4, 0.1},
                       {"heavy", 10, 9, 0.1}});
  const CostId similar = costs.add("fixed inverse=exact samples=12");
  const CostId unknown = costs.add("never heard of");
  EXPECT_NEAR(expected_ms(costs, similar, 1000, 0), 1.01, 1e-9);
  EXPECT_NEAR(expected_ms(costs, unknown, 1000, 0), 9.01, 1e-9);
  CostEstimator empty;
  EXPECT_GT(expected_ms(empty, empty.add("never heard of"), 1000, 0), 0);
}

// A slider of a host's pass that is not in the calibration, and cheap.
TEST(CostEstimator, OtherSettingOfMeasuredWork_CostsAsMuch) {
  CostEstimator costs({{"heavy", 300, 9, 0.1}});
  const CostId first = costs.add("host.grade strength=1"), heavy = costs.add("heavy");
  double clock_s = 0;
  observe(costs, {{first, 1, 0.01}, {heavy, 100, 1.2}}, 100, clock_s);
  ASSERT_NEAR(expected_ms(costs, first, 1, clock_s), 0.01, 2e-3);
  const CostId other = costs.add("host.grade strength=2");
  EXPECT_NEAR(expected_ms(costs, other, 1, clock_s), 0.01, 2e-3);
}

// Noise that widened a margin may be over while another configuration runs.
TEST(TimeMargins, MarginOfWhatDoesNotRun_ApproachesThatOfWhatRuns) {
  TimeMargins margins;
  margins.restart(2, 0.05);
  for (int i = 0; i < 200; ++i)
    margins.observe(0, 1, i % 4 == 0 ? 1.4 : 1, 0.95);
  const double wide = margins.margin(0);
  EXPECT_GT(wide, 0.15);
  for (int i = 0; i < 1000; ++i)
    margins.observe(1, 1, i % 30 == 0 ? 1.1 : 1, 0.95);
  EXPECT_GT(margins.margin(0), 0.8 * wide) << "not at once";
  for (int i = 0; i < 30000; ++i)
    margins.observe(1, 1, i % 30 == 0 ? 1.1 : 1, 0.95);
  EXPECT_NEAR(margins.margin(0), margins.margin(1), 1e-3);
}

TEST(CostEstimator, UnknownCommand_CostsLittle) {
  CostEstimator costs({{"heavy", 300, 9, 0.1}, {"clear depth=1", 20, 0, 0.1}});
  EXPECT_LE(expected_ms(costs, costs.add("copy", false), 1, 0), 0.01);
  EXPECT_NEAR(expected_ms(costs, costs.add("clear depth=0", false), 1, 0), 0.02, 1e-9);
}

TEST(CostEstimator, SlowFrames_AreKnown) {
  CostEstimator costs({{"a", 10, 1, 0.1}});
  const CostId a = costs.add("a");
  const PassTime frame[] = {{a, 1000, 1.5}};
  double clock_s = 0;
  for (int i = 0; i < 10; ++i)
    costs.observe(frame, clock_s += 0.8);
  EXPECT_TRUE(costs.predict(clock_s + 0.8)[a.value].measured);
  EXPECT_FALSE(costs.predict(clock_s + 10)[a.value].measured);
  // A single pause among fast frames is not the frame rate.
  observe(costs, {{a, 1000, 1.5}}, 10, clock_s);
  costs.observe(frame, clock_s += 3);
  EXPECT_FALSE(costs.predict(clock_s + 0.6)[a.value].measured);
}

// Hours do not make work uncertain that is added then.
TEST(CostEstimator, WorkAddedLater_IsNotForgotten) {
  CostEstimator early({{"a", 10, 1, 0.1}, {"b", 10, 1, 0.1}}), late = early;
  const auto optimistic = [](CostEstimator& costs, double clock_s) {
    const CostId a = costs.add("a"), b = costs.add("b");
    observe(costs, {{a, 1000, 1.01}}, 2, clock_s);
    return double(costs.predict(clock_s)[b.value].optimistic);
  };
  EXPECT_DOUBLE_EQ(optimistic(early, 0), optimistic(late, 36000));
}

TEST(CostEstimator, InvalidTimes_AreIgnored) {
  CostEstimator costs({{"work", 10, 1, 0.1}});
  const CostId id = costs.add("work");
  double clock_s = 0;
  observe(costs, {{id, 100, 1.0}}, 1, clock_s);
  const double before = expected_ms(costs, id, 100, clock_s);
  for (const double bad : {std::nan(""), double(INFINITY), -1.0})
    observe(costs, {{id, 100, bad}}, 1, clock_s);
  EXPECT_EQ(expected_ms(costs, id, 100, clock_s), before);
}

TEST(CostEstimator, WorkCalibratedAsFree_HasFiniteTimes) {
  CostEstimator costs({{"work", 0, 0, 0}});
  const CostId id = costs.add("work");
  double clock_s = 0;
  observe(costs, {{id, 100, 1.0}}, 200, clock_s);
  EXPECT_NEAR(costs.predict(clock_s)[id.value].expected * min_calibrated_ms, 1.0, 0.01);
}

TEST(Calibration, ReadsBackFromItsFile) {
  CostEstimator costs;
  const CostId b = costs.add("b"), a = costs.add("a");
  costs.add("never run");
  double clock_s = 0;
  for (uint64_t groups = 100; groups < 2000; groups += 100) {
    const double ms = 0.05 + 0.0002 * static_cast<double>(groups);
    observe(costs, {{a, groups, ms}, {b, groups, 2 * ms}}, 1, clock_s);
  }
  const Calibration out{"a device", same_device_uncertainty, costs.calibration()};
  ASSERT_EQ(out.costs.size(), 2u);
  EXPECT_EQ(out.costs[0].work, "a");         // Sorted by name.
  EXPECT_NEAR(out.costs[0].base_us, 50, 10); // the cost of unknown work pulls
  EXPECT_NEAR(out.costs[0].group_us, 0.2, 0.01);
  const std::string text = write_calibration(out);
  Diagnostics diagnostics;
  const auto document = parse_document("calibration.json", text, diagnostics);
  ASSERT_TRUE(document);
  const auto back = read_calibration(*document, diagnostics);
  ASSERT_TRUE(back) << format_as_json(diagnostics);
  EXPECT_EQ(write_calibration(*back), text);
  EXPECT_EQ(back->uncertainty, same_device_uncertainty);
  EXPECT_EQ(back->costs[0].uncertainty, same_device_uncertainty);
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
