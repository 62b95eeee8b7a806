// Tests FLIP: properties for any pictures, and values computed by hand from the papers' equations.
#include "integration/tools/files/flip.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace dermis::tools {
namespace {

Image even(float r, float g, float b, uint32_t side = 32) {
  Image image = Image::sized(side, side, 3);
  for (size_t i = 0; i < image.values.size(); i += 3) {
    image.values[i] = r;
    image.values[i + 1] = g;
    image.values[i + 2] = b;
  }
  return image;
}

Image noise(uint32_t seed, float maximum = 1) {
  Image image = Image::sized(40, 24, 3);
  std::mt19937 generator(seed);
  // Bits of the generator itself, because distributions differ between libraries.
  for (float& value : image.values)
    value = maximum * static_cast<float>(generator() >> 8) / float(1u << 24);
  return image;
}

double mean(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values)
    sum += double(value);
  return sum / double(values.size());
}

TEST(Flip, EqualPictures_AreZero) {
  for (const bool high : {false, true}) {
    const Image image = noise(1, high ? 20.0f : 1.0f);
    for (const float value : flip(image, image, high))
      EXPECT_EQ(value, 0.0f);
  }
}

TEST(Flip, IsBetweenZeroAndOne) {
  for (uint32_t seed = 0; seed < 8; ++seed)
    for (const float value : flip(noise(2 * seed), noise(2 * seed + 1), false)) {
      EXPECT_GE(value, 0.0f);
      EXPECT_LE(value, 1.0f);
    }
}

TEST(Flip, IsSymmetricForScreenColours) {
  const Image a = noise(5), b = noise(6);
  EXPECT_EQ(flip(a, b, false), flip(b, a, false));
}

// Filters keep an even picture unchanged, and it has no features. The rest is the difference of two
// colours, which is mapped so that green against blue is 1 (2020, section 4.1.3).
TEST(Flip, GreenAgainstBlueIsOne) {
  for (const float value : flip(even(0, 1, 0), even(0, 0, 1), false))
    EXPECT_NEAR(value, 1.0, 1e-5);
}

// 100 in lightness and no colour: 100^0.7 = 25.119. Green and blue are 203.02^0.7 = 41.25 apart, so
// the knee is at 16.50, and the result above the knee is (25.119 - 16.50) / (41.25 - 16.50) of
// 0.05. The four digits leave the white point's last digit open.
TEST(Flip, BlackAgainstWhiteMatchesTheEquations) {
  for (const float value : flip(even(0, 0, 0), even(1, 1, 1), false))
    EXPECT_NEAR(value, 0.96738, 1e-5);
}

TEST(Flip, GrowsWithTheDifference) {
  double before = 0;
  for (const float step : {0.01f, 0.03f, 0.1f, 0.3f, 0.8f}) {
    const double now =
        mean(flip(even(0.2f, 0.2f, 0.2f), even(0.2f + step, 0.2f + step, 0.2f + step), false));
    EXPECT_GT(now, before);
    before = now;
  }
}

// With the same pixels a tenth as far away: an eye averages a distant checkerboard and resolves a
// near one.
TEST(Flip, UnresolvedDetailCountsLess) {
  Image board = even(0, 0, 0);
  for (uint32_t y = 0; y < board.height; ++y)
    for (uint32_t x = 0; x < board.width; ++x)
      if ((x + y) % 2 == 0)
        for (uint32_t c = 0; c < 3; ++c)
          board.at(x, y, c) = 1;
  const Image grey = even(0.5f, 0.5f, 0.5f);
  EXPECT_LT(mean(flip(grey, board, false, 200)), 0.25 * mean(flip(grey, board, false, 10)));
}

TEST(Flip, EdgeCountsMoreThanItsColour) {
  const Image grey = even(0.3f, 0.3f, 0.3f, 64);
  Image line = grey;
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t c = 0; c < 3; ++c)
      line.at(32, y, c) = 0.8f;
  const std::vector<float> seen = flip(grey, line, false);
  EXPECT_GT(seen[32 * 64 + 32], 0.3f);
  EXPECT_NEAR(seen[32 * 64 + 2], 0.0f, 1e-6); // Far beyond the filters' reach.
}

TEST(Flip, HighRange_IgnoresTheUnitOfLight) {
  const Image a = noise(8), b = noise(9);
  Image bright_a = a, bright_b = b;
  for (size_t i = 0; i < a.values.size(); ++i) {
    bright_a.values[i] *= 1024; // A power of two: exact.
    bright_b.values[i] *= 1024;
  }
  const auto one = flip(a, b, true), other = flip(bright_a, bright_b, true);
  for (size_t i = 0; i < one.size(); ++i)
    EXPECT_NEAR(one[i], other[i], 1e-5);
}

TEST(Flip, HighRange_SeesBrightDifferences) {
  Image a = even(0.5f, 0.5f, 0.5f), b = a;
  for (uint32_t c = 0; c < 3; ++c) {
    a.at(16, 16, c) = 50;
    b.at(16, 16, c) = 20;
  }
  EXPECT_EQ(mean(flip(a, b, false)), 0);
  EXPECT_GT(flip(a, b, true)[16 * 32 + 16], 0.05f);
}

TEST(Flip, NonFiniteValues_AreAccepted) {
  Image a = noise(3);
  a.values[7] = std::numeric_limits<float>::quiet_NaN();
  a.values[8] = -std::numeric_limits<float>::infinity();
  for (const bool high : {false, true})
    for (const float value : flip(a, noise(4), high))
      EXPECT_TRUE(std::isfinite(value));
  for (const float value : flip(even(0, 0, 0), even(0, 0, 0), true))
    EXPECT_EQ(value, 0.0f);
}

} // namespace
} // namespace dermis::tools
