// Tests light sampling: fractions, places and irradiance.
#include "tests/passes/restir/cpu/lights.hpp"
#include "tests/passes/restir/cpu/random.hpp"
#include "tests/passes/restir/statistics.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace dermis::restir {
namespace {

std::vector<Light> some_lights() {
  std::vector<Light> lights(4);
  lights[0].position = {1, 2, 3};
  lights[0].emission = {2, 2, 2};
  lights[1].type = LightType::parallelogram;
  lights[1].position = {-1, -1, 2};
  lights[1].edge_u = {0, 2, 0};
  lights[1].edge_v = {2, 0, 0}; // Shines down.
  lights[1].emission = {3, 3, 3};
  lights[2] = lights[1];
  lights[2].type = LightType::triangle;
  lights[3].type = LightType::directional;
  lights[3].position = {0, 0.6, 0.8};
  lights[3].area = 100;
  lights[3].emission = {1, 1, 1};
  share_lights(lights);
  return lights;
}

TEST(Lights, PickFrequencyMatchesTheFractions) {
  const std::vector<Light> lights = some_lights();
  EXPECT_NEAR(lights.back().until, 1, 1e-12);
  EXPECT_DOUBLE_EQ(lights[1].fraction, 2 * lights[2].fraction); // Twice the area.
  std::vector<double> found(lights.size());
  constexpr int draws = 100000; // The sd of a fraction is below 0.0016.
  Random random{1, 0, 0};
  for (int i = 0; i < draws; ++i)
    found[pick_light(lights, random_unit(random))] += 1.0 / draws;
  for (size_t i = 0; i < lights.size(); ++i)
    EXPECT_NEAR(found[i], lights[i].fraction, 0.008);
  EXPECT_EQ(pick_light(lights, 1.5), lights.size() - 1);
}

TEST(Lights, DarkLights_AreUniform) {
  std::vector<Light> dark(3);
  share_lights(dark);
  for (const Light& light : dark)
    EXPECT_DOUBLE_EQ(light.fraction, 1.0 / 3);
  share_lights({});
}

TEST(Lights, AreaLight_MatchesItsIntegral) {
  // Below the middle of a square of half side 1 at height 2 with radiance 3: E = 3 times four times
  // the form factor of a corner, a = b = 1/2: F = (x atan(y / x') + ...) / 2 pi (Howell, C-11).
  const std::vector<Light> lights = some_lights();
  const double a = 0.5, s = std::sqrt(1 + a * a);
  const double corner = (a / s * std::atan(a / s) * 2) / (2 * std::numbers::pi);
  const double reference = 3 * std::numbers::pi * 4 * corner;
  std::vector<double> values, triangle;
  Random random{2, 0, 0};
  for (int i = 0; i < 20000; ++i) {
    const double u = random_unit(random), v = random_unit(random);
    const uint32_t place = light_place(u, v);
    const auto light_of = [&](const Light& light) {
      return light.area * light_irradiance(light, place, {0, 0, 0}, {0, 0, 1}, {0, 0, 1})[0];
    };
    values.push_back(light_of(lights[1]));
    triangle.push_back(light_of(lights[2]));
  }
  const testing::Mean mean = testing::mean_of(values), half = testing::mean_of(triangle);
  const double limit = testing::three_sigma_limit(19999, 2);
  EXPECT_NEAR(mean.mean, reference, limit * mean.sigma);
  EXPECT_NEAR(half.mean, reference / 2, limit * half.sigma); // Half of the square, by symmetry.
  EXPECT_LT(mean.sigma, 0.005 * reference);
}

TEST(Lights, IrradianceComesOnlyFromTheFront) {
  const std::vector<Light> lights = some_lights();
  const uint32_t middle = light_place(0.5, 0.5);
  const Vector3 up = {0, 0, 1}, down = {0, 0, -1};
  // Inverse square.
  EXPECT_NEAR(light_irradiance(lights[0], middle, {1, 2, 1}, up, up)[1], 2.0 / 4, 1e-12);
  EXPECT_NEAR(light_irradiance(lights[3], middle, {1, 2, 1}, up, up)[1], 0.8, 1e-12);
  for (const Light& light : lights) {
    // The surface faces away.
    EXPECT_EQ(light_irradiance(light, middle, {0, 0, 0}, down, up), Vector3{});
    EXPECT_EQ(light_irradiance(light, middle, {0, 0, 0}, up, down), Vector3{});
  }
  // Above the light.
  EXPECT_EQ(light_irradiance(lights[1], middle, {0, 0, 4}, down, down), Vector3{});
  // At the light.
  EXPECT_EQ(light_irradiance(lights[0], middle, lights[0].position, up, up), Vector3{});
}

} // namespace
} // namespace dermis::restir
