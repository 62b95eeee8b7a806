// Tests probes, their density, and the inversion that recovers their random numbers.
#include "passes/common/profiles/burley_profile.hpp"
#include "tests/passes/restir/cpu/reuse.hpp"
#include "tests/passes/restir/statistics.hpp"
#include "tests/passes/restir/triangle_scene.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace dermis::restir {
namespace {

using testing::kolmogorov_smirnov;
using testing::kolmogorov_smirnov_limit;

std::array<double, 4> four_units(Random& random) {
  std::array<double, 4> u;
  for (double& one : u)
    one = random_unit(random);
  return u;
}

// Builds one large plane z = 0 and a pixel whose probe axes are all oblique to the plane, so that
// each probe hits it once.
testing::TriangleScene slanted_plane() {
  testing::TriangleScene scene;
  constexpr double far = 1000;
  testing::add_instance(scene, 1, {{-far, -far, 0}, {far, -far, 0}, {0, far, 0}});
  scene.lights.resize(1);
  testing::finish(scene);
  return scene;
}
Domain slanted_domain() {
  return {{0.2, 0.1, 0}, normalize(Vector3{1, 1, 1}), {1, 0.5, 0.3}, 1};
}

TEST(Probe, ReachMatchesTheEnergyFraction) {
  EXPECT_NEAR(reach_in_d(), 19.86022, 1e-5);
  EXPECT_NEAR(subsurface::burley_cdf(reach_in_d(), 1), probe_fraction, 1e-12);
}

TEST(Profile, WholePlaneOfLight_IsOne) {
  const Vector3 d = {2, 0.7, 0.1};
  const double reach = scattering_reach(d);
  Vector3 sum{};
  constexpr int steps = 200000; // Midpoints in sqrt(r), in which 2 pi r R dr is smooth.
  for (int i = 0; i < steps; ++i) {
    const double q = (i + 0.5) / steps * std::sqrt(reach), r = q * q;
    sum = sum +
          2 * std::numbers::pi * r * 2 * q * std::sqrt(reach) / steps * scattering_profile(d, r);
  }
  for (const double one : sum)
    EXPECT_NEAR(one, 1, 1e-6);
  EXPECT_EQ(scattering_profile(d, reach * 1.001), Vector3{});
  EXPECT_EQ(scattering_profile({1, 0, 2}, 0.5)[1], 0);
}

TEST(Probe, AxesAreOrthogonal) {
  Random random{1, 0, 0};
  for (int i = 0; i < 1000; ++i) {
    Vector3 n = {random_unit(random) - 0.5, random_unit(random) - 0.5, random_unit(random) - 0.5};
    n = i == 0 ? Vector3{0, 0, -1} : normalize(n);
    for (uint32_t a = 0; a < 3; ++a)
      for (uint32_t b = 0; b < 3; ++b)
        EXPECT_NEAR(dot(probe_axis(n, a), probe_axis(n, b)), a == b, 1e-12);
  }
}

TEST(Probe, ChoiceFrequencyMatchesTheFractions) {
  // With 2e5 samples the sd of a fraction is below 0.0012; the bound is five sd.
  constexpr int draws = 200000;
  for (const Vector3& d : {Vector3{1, 2, 3}, {1, 0, 3}, {0, 0, 3}}) {
    double axes[3] = {}, channels[3] = {};
    Random random{7, 0, 0};
    for (int i = 0; i < draws; ++i) {
      const ProbeNumbers numbers = draw_numbers(d, four_units(random));
      axes[numbers.axis] += 1.0 / draws;
      channels[numbers.channel] += 1.0 / draws;
    }
    const double scattering =
        double(std::count_if(d.begin(), d.end(), [](double x) { return x > 0; }));
    for (size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(axes[i], probe_axis_fraction[i], 0.006);
      EXPECT_NEAR(channels[i], d[i] > 0 ? 1 / scattering : 0, 0.006);
    }
  }
}

// The weights hits / density of probe samples estimate areas: of a disc on the oblique plane, and
// of the scene's surfaces within a ball.
TEST(Probe, WeightsMeasureAreas) {
  const testing::TriangleScene plane = slanted_plane();
  const Scene scene = plane.access();
  const Domain domain = slanted_domain();
  std::vector<double> values;
  Random random{5, 0, 0};
  for (int batch = 0; batch < 64; ++batch) {
    double sum = 0;
    constexpr int draws = 2000;
    for (int i = 0; i < draws; ++i) {
      const ProbeNumbers numbers = draw_numbers(domain.d, four_units(random));
      ProbeHits hits;
      scene.trace_probe(scene.of, probe_of(domain, numbers), 1, hits);
      if (hits.count == 0) continue;
      const ProbeHit& hit = hits.hit[picked_hit(numbers.pick, hits.count)];
      const SurfacePoint x2 =
          scene.surface_at(scene.of, hit.instance, hit.primitive, hit.barycentrics);
      if (length(x2.position - domain.position) < 1.5)
        sum += hits.count / probe_pdf(domain, x2.position, x2.normal) / draws;
    }
    values.push_back(sum);
  }
  const testing::Mean mean = testing::mean_of(values);
  EXPECT_NEAR(mean.mean, std::numbers::pi * 1.5 * 1.5,
              testing::three_sigma_limit(63, 1) * mean.sigma);
  EXPECT_LT(mean.sigma, 0.02 * mean.mean);
}

TEST(Inversion, RecoversThePoint) {
  const testing::TriangleScene ear = testing::ear_scene();
  const Scene scene = ear.access();
  const std::vector<testing::Pixel> pixels = testing::look_at(ear, 24, 24);
  Random random{11, 0, 0};
  int found = 0, several = 0;
  for (int i = 0; i < 60000; ++i) {
    const Domain& domain = pixels[static_cast<size_t>(i) % pixels.size()].domain;
    if (domain.medium == 0) continue;
    const ProbeNumbers probe_numbers = draw_numbers(domain.d, four_units(random));
    ProbeHits hits;
    scene.trace_probe(scene.of, probe_of(domain, probe_numbers), domain.medium, hits);
    if (hits.count == 0) continue;
    const ProbeHit& hit = hits.hit[picked_hit(probe_numbers.pick, hits.count)];
    const SurfacePoint x2 =
        scene.surface_at(scene.of, hit.instance, hit.primitive, hit.barycentrics);
    ProbeNumbers again;
    ASSERT_TRUE(invert_point(domain, x2.position, x2.normal, random_unit(random), again));
    ProbeHits seen;
    scene.trace_probe(scene.of, probe_of(domain, again), domain.medium, seen);
    // A probe that grazes an edge or a face may miss by rounding, so cosines below 1e-6 are
    // skipped.
    if (std::abs(dot(x2.normal, probe_axis(domain.normal, again.axis))) < 1e-6) continue;
    const double edge = std::min(
        {hit.barycentrics[0], hit.barycentrics[1], 1 - hit.barycentrics[0] - hit.barycentrics[1]});
    if (edge < 1e-9) continue;
    ASSERT_TRUE(invert_pick(seen, hit.instance, hit.primitive, random_unit(random), again.pick));
    const ProbeHit& back = seen.hit[picked_hit(again.pick, seen.count)];
    const SurfacePoint y2 =
        scene.surface_at(scene.of, back.instance, back.primitive, back.barycentrics);
    EXPECT_EQ(back.instance, hit.instance);
    EXPECT_EQ(back.primitive, hit.primitive);
    // 1e-15 of the scene over the minimum cosine.
    EXPECT_LT(length(y2.position - x2.position), 1e-6);
    ++found;
    several += seen.count > 1;
  }
  EXPECT_GT(found, 10000);
  EXPECT_GT(several, found / 4);
}

// Recovered numbers are as uniform as generated numbers. Discs reach up to 0.57 of the reach, where
// every probe hits an oblique plane: cos 54.7 degrees = 1 / sqrt(3).
TEST(Inversion, FindsUniformNumbers) {
  const testing::TriangleScene plane = slanted_plane();
  const Scene scene = plane.access();
  const Domain domain = slanted_domain();
  const double min_survival = 1 - subsurface::burley_cdf(0.57 * reach_in_d(), 1);
  std::vector<double> techniques, radii, angles, picks;
  Random random{13, 0, 0};
  while (techniques.size() < 100000) {
    const ProbeNumbers probe_numbers = draw_numbers(domain.d, four_units(random));
    ProbeHits hits;
    scene.trace_probe(scene.of, probe_of(domain, probe_numbers), 1, hits);
    if (hits.count == 0) continue;
    ASSERT_EQ(hits.count, 1u);
    const ProbeHit& hit = hits.hit[0];
    const SurfacePoint x2 =
        scene.surface_at(scene.of, hit.instance, hit.primitive, hit.barycentrics);
    ProbeNumbers found;
    ASSERT_TRUE(invert_point(domain, x2.position, x2.normal, random_unit(random), found));
    ASSERT_TRUE(invert_pick(hits, hit.instance, hit.primitive, random_unit(random), found.pick));
    if (found.survival < min_survival) continue;
    // The third number of the supplement: a uniform place in the interval of the choice.
    double below = 0;
    for (uint32_t a = 0; a < found.axis; ++a)
      below += probe_axis_fraction[a];
    techniques.push_back(below + probe_axis_fraction[found.axis] *
                                     (found.channel + random_unit(random)) / 3);
    radii.push_back((1 - found.survival) / (1 - min_survival));
    angles.push_back(found.angle);
    picks.push_back(found.pick);
  }
  EXPECT_LT(kolmogorov_smirnov(techniques), kolmogorov_smirnov_limit);
  EXPECT_LT(kolmogorov_smirnov(radii), kolmogorov_smirnov_limit);
  EXPECT_LT(kolmogorov_smirnov(angles), kolmogorov_smirnov_limit);
  EXPECT_LT(kolmogorov_smirnov(picks), kolmogorov_smirnov_limit);
}

TEST(Inversion, UnreachablePoint_Fails) {
  const Domain domain = {{0, 0, 0}, {0, 0, 1}, {1, 0.5, 0.2}, 1};
  ProbeNumbers numbers;
  EXPECT_FALSE(invert_point(domain, {0, 0, 30}, {0, 0, 1}, 0.5, numbers)); // Beyond the reach.
  EXPECT_FALSE(invert_point(domain, {0, 0, std::nan("")}, {0, 0, 1}, 0.5, numbers));
  // A triangle without area.
  EXPECT_FALSE(invert_point(domain, {0, 0, 1}, {0, 0, 0}, 0.5, numbers));
  Domain opaque = domain;
  opaque.d = {0, 0, 0};
  EXPECT_FALSE(invert_point(opaque, {0, 0, 0.1}, {0, 0, 1}, 0.5, numbers));
  double pick = 0;
  EXPECT_FALSE(invert_pick({}, 1, 2, 0.5, pick));
}

TEST(Inversion, AtTheOriginIsFinite) {
  const Domain domain = {{0, 0, 0}, {0, 0, 1}, {1, 0.5, 0.2}, 1};
  ProbeNumbers numbers;
  ASSERT_TRUE(invert_point(domain, {0, 0, 0}, {0, 0, 1}, 0.5, numbers));
  EXPECT_TRUE(std::isfinite(numbers.angle));
  EXPECT_EQ(numbers.survival, 1);
  EXPECT_TRUE(std::isfinite(probe_pdf(domain, {0, 0, 0}, {0, 0, 1})));
  EXPECT_TRUE(std::isfinite(luminance(scattering_profile(domain.d, 0))));
}

TEST(Neighbours, SearchRadiusIsTwiceTheWidestD) {
  EXPECT_EQ(search_radius({1, 3, 2}, 0.5), 12);
  EXPECT_EQ(search_radius({1, 3, 2}, 0.01), 30);
  EXPECT_EQ(search_radius({1, 3, 2}, 100), 5);
  EXPECT_EQ(search_radius({0, 0, 0}, 0), 5); // 0 / 0
}

} // namespace
} // namespace dermis::restir
