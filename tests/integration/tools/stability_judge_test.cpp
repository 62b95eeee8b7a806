// Tests which wrong frames the stability bench detects.
#include "integration/tools/command/bench/stability/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace dermis::tools {
namespace {

StabilityCase white(Metric metric) {
  StabilityCase made;
  made.name = "white";
  made.given = [](uint32_t) { return sound_frame(); };
  made.expected = [](uint32_t) { return 1.0; };
  made.metric = metric;
  return made;
}

// Returns white light with equal sample counts in each pixel.
StabilityAnswer white_answer(float samples = 8) {
  const size_t values = size_t{3} * stability_side * stability_side;
  return {std::vector<float>(values, 1.0f), std::vector<float>(values, samples)};
}

size_t index(uint32_t x, uint32_t y, uint32_t channel = 0) {
  return 3 * (size_t{y} * stability_side + x) + channel;
}

TEST(StabilityJudge, DetectsSinglePixelsAndNonFiniteValues) {
  const StabilityCase requested = white(Metric::light);
  StabilityAnswer found = white_answer();
  EXPECT_EQ(judge(requested, 0, found, nullptr).error, 0);
  found.light[index(3, 5, 1)] = 0.75f;
  found.light[index(4, 5)] = not_a_number;
  const Judgement judgement = judge(requested, 0, found, nullptr);
  EXPECT_DOUBLE_EQ(judgement.error, 0.25);
  EXPECT_EQ(judgement.nonfinite, 1u);
}

// An error may be within its bound although light is negative.
TEST(StabilityJudge, CountsNegativePixels) {
  StabilityCase requested = white(Metric::light);
  requested.margin = 4;
  requested.finite_only = true;
  StabilityAnswer found = white_answer();
  found.light[index(0, 0, 2)] = -1e-6f;
  found.light[index(9, 9)] = found.light[index(9, 9, 1)] = -1;
  found.light[index(10, 9)] = -infinity;
  found.light[index(11, 9)] = -0.0f;
  const Judgement judgement = judge(requested, 0, found, nullptr);
  EXPECT_EQ(judgement.negative, 2u);
  EXPECT_EQ(judgement.nonfinite, 1u);
}

TEST(StabilityJudge, LightUpToTheBrightestIsAccepted) {
  StabilityCase requested = white(Metric::light_beyond);
  requested.scale = 2;
  StabilityAnswer found = white_answer();
  found.light[index(3, 3)] = 0;
  found.light[index(4, 3)] = 2;
  EXPECT_EQ(judge(requested, 0, found, nullptr).error, 0);
  found.light[index(5, 3)] = 2.5f;
  EXPECT_DOUBLE_EQ(judge(requested, 0, found, nullptr).error, 0.25);
  found.light[index(6, 3)] = -1;
  EXPECT_DOUBLE_EQ(judge(requested, 0, found, nullptr).error, 0.5);
}

TEST(StabilityJudge, ChecksOnlyItsChannelsInsideTheMargin) {
  StabilityCase requested = white(Metric::light);
  requested.first_channel = 2;
  requested.margin = 4;
  StabilityAnswer found = white_answer();
  found.light[index(10, 10, 1)] = found.light[index(3, 10, 2)] = found.light[index(10, 44, 2)] = 0;
  EXPECT_EQ(judge(requested, 0, found, nullptr).error, 0);
  found.light[index(4, 43, 2)] = 0;
  EXPECT_EQ(judge(requested, 0, found, nullptr).error, 1);
}

TEST(StabilityJudge, NoExpectation_TheLightMustStay) {
  StabilityCase requested = white(Metric::light);
  requested.expected = nullptr;
  requested.given = [](uint32_t) { return textured_frame(); };
  StabilityAnswer found{textured_frame().lighting.values, {}};
  EXPECT_EQ(judge(requested, 0, found, nullptr).error, 0);
  found.light[index(7, 7)] += 0.125f;
  EXPECT_NEAR(judge(requested, 0, found, nullptr).error, 0.125, 1e-6);
}

TEST(StabilityJudge, SeamsAreEdgesOfAllTiles) {
  const StabilityCase requested = white(Metric::tile_edges);
  StabilityAnswer all = white_answer(), pixel = white_answer(), columns = white_answer(),
                  rows = white_answer();
  for (uint32_t y = 0; y < stability_side; ++y)
    for (uint32_t x = 0; x < stability_side; ++x)
      for (uint32_t c = 0; c < 3; ++c) {
        all.light[index(x, y, c)] = 0.5f;
        if (x % 8 == 0) columns.light[index(x, y, c)] = 0.875f;
        if (y % 16 == 15) rows.light[index(x, y, c)] = 0.875f;
      }
  pixel.light[index(9, 9)] = 0.5f;
  EXPECT_NEAR(judge(requested, 0, all, nullptr).error, 0, 1e-12);
  // 0.5 of one of 432 values of a line.
  EXPECT_LT(judge(requested, 0, pixel, nullptr).error, 0.002);
  EXPECT_NEAR(judge(requested, 0, columns, nullptr).error, 0.125 * 7 / 8, 1e-6);
  EXPECT_NEAR(judge(requested, 0, rows, nullptr).error, 0.125 * 15 / 16, 1e-6);
}

TEST(StabilityJudge, SamplesAreComparedByTheirMeans) {
  EXPECT_DOUBLE_EQ(judge(white(Metric::samples_at_edge), 0, white_answer(32), nullptr).error, 0.25);
  EXPECT_DOUBLE_EQ(judge(white(Metric::samples_at_edge), 0, white_answer(8), nullptr).error, 1);
  const StabilityAnswer sound = white_answer(20);
  StabilityCase other = white(Metric::mean_samples);
  other.same_as = other.given;
  EXPECT_NEAR(judge(other, 0, white_answer(21), &sound).error, 0.05, 1e-12);
  StabilityAnswer uneven = white_answer(8);
  uneven.samples[index(20, 20)] = 64;
  EXPECT_DOUBLE_EQ(judge(white(Metric::samples_in_tile), 0, uneven, nullptr).error,
                   64 / (8 + 56.0 / 64));
}

TEST(StabilityJudge, MissingSamples_Fail) {
  StabilityAnswer none = white_answer();
  none.samples.clear();
  const StabilityAnswer zero = white_answer(0);
  for (const Metric metric :
       {Metric::samples_at_edge, Metric::samples_in_tile, Metric::mean_samples})
    for (const StabilityAnswer& found : {none, zero})
      EXPECT_GT(judge(white(metric), 0, found, &zero).error, 1e30);
}

} // namespace
} // namespace dermis::tools
