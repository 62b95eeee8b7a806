#include "tests/passes/restir/cpu/random.hpp"
#include "tests/passes/restir/cpu/reservoir.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace dermis::restir {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinite = std::numeric_limits<double>::infinity();

Reservoir some_reservoir() {
  Reservoir r;
  r.instance = (1u << 24) + 1; // The first integer that no float can hold.
  r.primitive = 0xfffffffe;
  r.barycentrics = {0.25, 0.375};
  r.light = 0xfedcba98;
  r.place = 0x87654321;
  r.numbers = {2, 1, 0.5, 0.875, 0.0625};
  r.hits = max_probe_hits;
  r.density = 3.5;
  r.irradiance = {1, 2, 4};
  r.weight = 0.125;
  r.confidence = 20;
  return r;
}

bool is_clean(const Reservoir& r) {
  return std::isfinite(r.weight) && r.weight >= 0 && std::isfinite(r.confidence) &&
         r.confidence >= 0 && r.confidence <= max_confidence && std::isfinite(r.density) &&
         std::isfinite(luminance(r.irradiance));
}

TEST(Reservoir, PackingRoundTripIsExact) {
  // All numbers above are exact in a float, so the words must return them unchanged.
  const Reservoir r = some_reservoir(), s = unpack_reservoir(pack_reservoir(r));
  EXPECT_EQ(s.instance, r.instance);
  EXPECT_EQ(s.primitive, r.primitive);
  EXPECT_EQ(s.barycentrics, r.barycentrics);
  EXPECT_EQ(s.light, r.light);
  EXPECT_EQ(s.place, r.place);
  EXPECT_EQ(s.numbers.axis, r.numbers.axis);
  EXPECT_EQ(s.numbers.channel, r.numbers.channel);
  EXPECT_EQ(s.numbers.survival, r.numbers.survival);
  EXPECT_EQ(s.numbers.angle, r.numbers.angle);
  EXPECT_EQ(s.numbers.pick, r.numbers.pick);
  EXPECT_EQ(s.hits, r.hits);
  EXPECT_EQ(s.density, r.density);
  EXPECT_EQ(s.irradiance, r.irradiance);
  EXPECT_EQ(s.weight, r.weight);
  EXPECT_EQ(s.confidence, r.confidence);
}

TEST(Reservoir, IdsOfEveryBitSurvive) {
  for (uint32_t bit = 0; bit < 32; ++bit) {
    Reservoir r = some_reservoir();
    r.instance = 1u << bit | 1u;
    r.primitive = ~(1u << bit);
    const Reservoir s = unpack_reservoir(pack_reservoir(r));
    EXPECT_EQ(s.instance, r.instance);
    EXPECT_EQ(s.primitive, r.primitive);
  }
}

TEST(Reservoir, Sanitised_HasNoNaNOrInfinity) {
  for (const double bad : {nan, infinite, -infinite, -1.0, 1e300}) {
    for (int member = 0; member < 9; ++member) {
      Reservoir r = some_reservoir();
      double* const places[] = {&r.weight,       &r.density,          &r.irradiance[1],
                                &r.confidence,   &r.numbers.survival, &r.numbers.angle,
                                &r.numbers.pick, &r.barycentrics[0],  &r.barycentrics[1]};
      *places[member] = bad;
      const Reservoir s = unpack_reservoir(pack_reservoir(r));
      EXPECT_TRUE(is_clean(s)) << bad << " in " << member;
      const bool confidence = member == 3;
      EXPECT_EQ(has_sample(s), confidence) << bad << " in " << member;
      if (confidence) {
        EXPECT_EQ(s.confidence, bad > 1 ? max_confidence : 0) << bad;
      }
    }
  }
}

TEST(Reservoir, AnyWords_UnpackToAValidReservoir) {
  Random random{1, 2, 0};
  for (int i = 0; i < 100000; ++i) {
    PackedReservoir words;
    for (uint32_t& word : words)
      word = subsurface::pcg3d({random.pixel, random.frame, random.count++})[1];
    EXPECT_TRUE(is_clean(unpack_reservoir(words)));
  }
}

TEST(Reservoir, CandidateWithoutWeight_AddsOnlyConfidence) {
  for (const double weight : {nan, infinite, -1.0, 0.0})
    for (const double target : {nan, infinite, 0.0, 2.0}) {
      Stream stream;
      stream_add(stream, some_reservoir(), 4, 2, 1, 0.5);
      Reservoir other = some_reservoir();
      other.instance = 7;
      stream_add(stream, other, target, weight, 3, 1e-9);
      const Reservoir r = stream_end(stream);
      EXPECT_EQ(r.instance, some_reservoir().instance);
      EXPECT_EQ(r.weight, 0.5);
      EXPECT_EQ(r.confidence, 4);
    }
}

TEST(Reservoir, NoCandidates_EmptyWithConfidence) {
  Stream stream;
  stream_add(stream, some_reservoir(), 0, 0, 5, 0.5);
  const Reservoir r = stream_end(stream);
  EXPECT_FALSE(has_sample(r));
  EXPECT_EQ(r.weight, 0);
  EXPECT_EQ(r.confidence, 5);
}

TEST(Reservoir, SelectionFrequencyMatchesTheWeights) {
  // Three candidates of weights 1, 2 and 5. Fractions of 1e5 runs have an sd below 0.0016; the
  // bound is five sd.
  constexpr int runs = 100000;
  const double weights[] = {1, 2, 5};
  double fraction[3] = {};
  Random random{3, 4, 0};
  for (int run = 0; run < runs; ++run) {
    Stream stream;
    for (uint32_t i = 0; i < 3; ++i) {
      Reservoir r = some_reservoir();
      r.instance = i;
      stream_add(stream, r, 1, weights[i], 1, random_unit(random));
    }
    fraction[stream_end(stream).instance] += 1.0 / runs;
  }
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(fraction[i], weights[i] / 8, 0.008);
}

} // namespace
} // namespace dermis::restir
