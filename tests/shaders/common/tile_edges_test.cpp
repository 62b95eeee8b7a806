// Compares the weights that fade samples out towards tiles without samples, as kernels compute them
// on a device, with their definition: smoothstep of the distance in the maximum norm to the next
// tile without samples.
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_tile_edges.spv.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace dermis::subsurface::tile_edges_kernel {
namespace {

constexpr int across = 5, down = 4, side = 8, arrangements = 24; // Tiles.
constexpr uint32_t width = across * side, height = down * side * arrangements;
constexpr double ramps[] = {4, 8}; // Pixels.

struct Tile { // The layout that test_tile_edges.comp reads.
  float type, samples, unused[2];
};

// Tiles of class 1 scatter. Other tiles are copied or empty and blend nothing, so their samples are
// not needed.
std::vector<Tile> make_tiles() {
  std::mt19937 random(3);
  std::vector<Tile> tiles;
  for (uint32_t a = 0; a < arrangements; ++a)
    for (uint32_t i = 0; i < across * down; ++i) {
      // Arrangement 0 has a single tile without samples.
      const bool sampled = a == 0 ? i != 6 : random() % 4 != 0;
      // From arrangement 12 on, other classes and the bit of full tiles occur.
      const auto type = static_cast<float>((a < 12 ? 1 : random() % 4) + 4 * (random() % 2));
      tiles.push_back({type, sampled ? static_cast<float>(1 + random() % 3) : 0.0f, {}});
    }
  return tiles;
}

struct Arrangement {
  const Tile* tiles;
  bool has_samples(int x, int y) const {
    const Tile& tile = tiles[std::clamp(y, 0, down - 1) * across + std::clamp(x, 0, across - 1)];
    return tile.samples > 0 || int(tile.type) % 4 != 1;
  }
  // Returns the distance in ramps; 1 if no neighbour is without samples.
  double way_in_ramps(int x, int y, double ramp) const {
    const double px = x + 0.5, py = y + 0.5; // Pixel centre.
    double nearest = std::numeric_limits<double>::infinity();
    for (int ty = y / side - 1; ty <= y / side + 1; ++ty)
      for (int tx = x / side - 1; tx <= x / side + 1; ++tx) {
        if ((tx == x / side && ty == y / side) || has_samples(tx, ty)) continue;
        const double dx = std::max({side * tx - px, px - side * (tx + 1), 0.0});
        const double dy = std::max({side * ty - py, py - side * (ty + 1), 0.0});
        nearest = std::min(nearest, std::max(dx, dy));
      }
    return std::min(nearest / ramp, 1.0);
  }
};

class TileEdgesKernel : public dermis::testing::KernelTest {
protected:
  void SetUp() override {
    KernelTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    FrameConstants constants{};
    constants.tiles[0] = across;
    constants.tiles[1] = down;
    answers = answers_of({"test_tile_edges", test_tile_edges_spirv}, width, height,
                         {.questions = std::as_bytes(std::span(tiles)), .frame = &constants});
    ASSERT_EQ(answers.size(), size_t{4} * width * height);
  }
  double at(int a, int x, int y, size_t channel) const {
    return double(answers[4 * (size_t(a * down * side + y) * width + size_t(x)) + channel]);
  }
  Arrangement arrangement(int a) const { return {&tiles[size_t(a) * across * down]}; }

  const std::vector<Tile> tiles = make_tiles();
  std::vector<float> answers;
};

TEST_F(TileEdgesKernel, WeightsEqualTheirDefinition) {
  // The quotient is rounded twice, to 2.5 ulp each; t^2 (3 - 2 t) contains it three times, plus
  // three products and a difference.
  constexpr double ulps = 3 * 2 * 2.5 + 4, ulp = std::numeric_limits<float>::epsilon();
  for (int a = 0; a < arrangements; ++a)
    for (int y = 0; y < down * side; ++y)
      for (int x = 0; x < across * side; ++x)
        for (size_t r = 0; r < std::size(ramps); ++r) {
          const double t = arrangement(a).way_in_ramps(x, y, ramps[r]);
          ASSERT_NEAR(at(a, x, y, r), t * t * (3 - 2 * t), ulps * ulp * t * t * (3 + 2 * t))
              << "arrangement " << a << ", pixel " << x << " " << y << ", ramp " << ramps[r];
        }
}

TEST_F(TileEdgesKernel, TilesThatBlendNothingCountAsSampled) {
  for (int a = 0; a < arrangements; ++a)
    for (int y = 0; y < down; ++y)
      for (int x = 0; x < across; ++x) {
        EXPECT_EQ(at(a, side * x, side * y, 2), arrangement(a).has_samples(x, y) ? 1 : 0)
            << a << " " << x << " " << y;
        EXPECT_EQ(at(a, side * x, side * y, 3), arrangement(a).has_samples(x - 2, y - 2) ? 1 : 0)
            << "beyond the picture the edge tile is used: " << a << " " << x << " " << y;
      }
}

// Between adjacent pixels, also across a corner of four tiles, the weight changes by at most the
// steepest part of the ramp, 3/2 of its mean, so no seam is visible. Tiles without samples have
// weight 0.
TEST_F(TileEdgesKernel, AdjacentPixelsDifferByAtMostTheRamp) {
  const auto weight = [&](int a, int x, int y, size_t r) {
    return arrangement(a).has_samples(x / side, y / side) ? at(a, x, y, r) : 0.0;
  };
  for (int a = 0; a < arrangements; ++a)
    for (int y = 0; y + 1 < down * side; ++y)
      for (int x = 0; x + 1 < across * side; ++x)
        for (size_t r = 0; r < std::size(ramps); ++r)
          for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}})
            ASSERT_LE(std::abs(weight(a, x, y, r) - weight(a, x + dx, y + dy, r)),
                      1.5 / ramps[r] + 1e-6)
                << "arrangement " << a << ", pixel " << x << " " << y << " to " << dx << " " << dy
                << ", ramp " << ramps[r];
}

} // namespace
} // namespace dermis::subsurface::tile_edges_kernel
