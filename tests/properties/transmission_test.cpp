// Light from behind a slab: the part of the profile beyond the slab's thickness.
#include "tests/properties/plane.hpp"

#include <cmath>

namespace {

using namespace properties;

class Transmission : public DeviceTest {
protected:
  Plane slab(double thickness_in_d) {
    Plane plane{.width = 40, .height = 40, .d_px = {4, 2, 0}};
    plane.light = [](double, double) { return 0.25f; };
    const auto metres = static_cast<float>(thickness_in_d * 4e-3); // d of red is 4 mm.
    plane.thickness_m = [metres](int, int) { return metres; };
    return plane;
  }
};

TEST_F(Transmission, Slab_MatchesTheTwoExponentials) {
  for (const double t : {0.0, 0.1, 0.5, 1.0, 3.0, 10.0}) {
    const Picture picture = run("sap", slab(t), {{"transmission", "true"}});
    const double ratio[2] = {1, 2}; // Ratio of thickness to d: red, green.
    for (uint32_t c = 0; c < 2; ++c) {
      const double in_d = t * ratio[c];
      const double expected = 0.25 + 0.25 * (std::exp(-in_d) + 3 * std::exp(-in_d / 3));
      // fp16 storage at 1.
      EXPECT_NEAR(picture.at(20, 20, c), expected, 2e-3) << t << " d, channel " << c;
    }
    EXPECT_NEAR(picture.at(20, 20, 2), 0.25, 1e-3) << "without scattering nothing is transmitted";
  }
}

TEST_F(Transmission, IsOffByDefault) {
  const Picture picture = run("sap", slab(0.1), {});
  EXPECT_NEAR(picture.at(20, 20, 0), 0.25, 1e-3);
}

TEST_F(Transmission, ScattersAtTheSurface) {
  Plane plane = slab(0);
  plane.light = [](double, double) { return 0.0f; };
  plane.thickness_m = [](int x, int) { return x < 20 ? 0.0f : 1.0f; };
  const Picture picture = run("sap", plane, {{"transmission", "true"}});
  // Next to the thin half, light arrives through the surface.
  EXPECT_GT(picture.at(22, 20, 0), 0.05);
  EXPECT_LT(picture.at(18, 20, 0), 0.95);
}

} // namespace
