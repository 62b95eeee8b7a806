// The surface-aware pyramid skips tiles without subsurface; the skipped contents must not affect
// the picture.
#include "tests/framegraph/test_scale.hpp"
#include "tests/properties/plane.hpp"

#include <cmath>
#include <string_view>

namespace {

using namespace properties;

class Culling : public DeviceTest, public ::testing::WithParamInterface<const char*> {};

INSTANTIATE_TEST_SUITE_P(Properties, Culling, ::testing::Values("base", "smooth", "half"),
                         [](const auto& one) { return std::string(one.param); });

// An island with ragged borders, in a picture of its own size.
Plane island() {
  Plane plane{.width = 160, .height = 96, .d_px = {12, 5, 2}};
  plane.light = [](double x, double y) {
    return static_cast<float>(0.5 + 0.4 * std::sin(x * 0.31) * std::cos(y * 0.17));
  };
  plane.profile = [](int x, int y) {
    const bool shore = (x * 7 + y * 3) % 11 < 3 && (x < 20 || y > 80),
               hole = x > 70 && x < 99 && y > 30 && y < 60;
    return static_cast<uint8_t>(shore || hole ? 0 : x + y < 130 ? 1 : 2);
  };
  return plane;
}

// The same island among empty tiles, aligned to the grids of all levels as in its own picture (256
// px).
Plane among_empty_tiles(const Plane& island_plane) {
  Plane plane = island_plane;
  plane.width = 512;
  plane.height = 512;
  plane.light = [island_plane](double x, double y) { return island_plane.light(x - 256, y - 256); };
  plane.profile = [island_plane](int x, int y) {
    const bool inside = x >= 256 && x < 416 && y >= 256 && y < 352;
    return inside ? island_plane.profile(x - 256, y - 256) : uint8_t{0};
  };
  return plane;
}

TEST_P(Culling, StaleContentsOfEmptyTiles_ChangeNoBit) {
  if (std::string_view(GetParam()) == "base") DERMIS_FULL_TESTS_ONLY();
  const char* const graph = std::string_view(GetParam()) == "half" ? "skin" : "sap";
  const Settings settings = {{"variant", std::string("\"") + GetParam() + "\""}};
  const Plane island_plane = island();
  const Picture expected = run(graph, island_plane, settings);
  Plane plane = among_empty_tiles(island_plane);
  plane.earlier_profile = [](int x, int) { return static_cast<uint8_t>(x < 300 ? 1 : 2); };
  Picture picture;
  run_frames(graph, plane, settings, 2, [&](const Picture& each) { picture = each; });
  ASSERT_EQ(picture.width, plane.width);
  for (uint32_t y = 0; y < island_plane.height; ++y)
    for (uint32_t x = 0; x < island_plane.width; ++x)
      for (uint32_t c = 0; c < 3; ++c)
        ASSERT_EQ(picture.at(256 + x, 256 + y, c), expected.at(x, y, c)) << x << " " << y;
}

} // namespace
