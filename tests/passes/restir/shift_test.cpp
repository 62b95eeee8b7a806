// Tests shifts against their inverses, and Jacobians against finite differences.
#include "tests/passes/restir/cpu/reuse.hpp"
#include "tests/passes/restir/triangle_scene.hpp"

#include <gtest/gtest.h>

#include <optional>

namespace dermis::restir {
namespace {

using testing::TriangleScene;

// Step of the differences: the error is h^2 of the map, and 1e-10 by rounding.
constexpr double h = 1e-6;

double determinant(std::array<std::array<double, 4>, 4> m, size_t n) {
  double result = 1;
  for (size_t i = 0; i < n; ++i) {
    size_t pivot = i;
    for (size_t j = i; j < n; ++j)
      if (std::abs(m[j][i]) > std::abs(m[pivot][i])) pivot = j;
    std::swap(m[i], m[pivot]);
    result *= m[i][i];
    for (size_t j = i + 1; j < n; ++j)
      for (size_t k = n; k-- > i;)
        m[j][k] -= m[j][i] / m[i][i] * m[i][k];
  }
  return std::abs(result);
}

// Returns two orthogonal directions on a surface.
std::array<Vector3, 2> along(const Vector3& normal) {
  return {probe_axis(normal, 1), probe_axis(normal, 2)};
}

// The space in which random replay is one to one: x2 on its surface (two coordinates), gamma_1 with
// axis, channel and their unused fraction, and gamma_2 with the rest of the choice among hits
// (supplement, eq. 8 to 16).
struct Extended {
  double a = 0, b = 0, gamma_1 = 0, gamma_2 = 0;
};
struct Place {
  uint32_t instance = 0, primitive = 0, technique = 0, hit = 0;
  Vector3 position{}, normal{};
};

// Maps x2 of `at` in `from`, moved by e; returns null if the image leaves the faces and choices of
// `image`.
std::optional<Extended> replayed(const Scene& scene, const Domain& from, const Domain& to,
                                 const Place& at, const Extended& e, uint32_t hits,
                                 std::optional<Place>& image) {
  const auto axes = along(at.normal);
  const Vector3 x2 = at.position + e.a * axes[0] + e.b * axes[1];
  const auto technique_pdf = [&](const Domain& domain, uint32_t t, const Vector3& p,
                                 const Vector3& n) {
    return probe_technique_pdf(domain, t / 3, t % 3, p, n);
  };
  ProbeNumbers numbers;
  double below = 0;
  for (uint32_t t = 0; t < at.technique; ++t)
    below += technique_pdf(from, t, x2, at.normal);
  const double own = technique_pdf(from, at.technique, x2, at.normal),
               sum = probe_pdf(from, x2, at.normal);
  const double u = (e.gamma_1 * sum - below) / own; // Within the interval of the choice.
  if (u < 0 || u >= 1) return {};
  // invert_point picks the technique whose interval contains gamma_1.
  if (!invert_point(from, x2, at.normal, e.gamma_1, numbers)) return {};
  if (numbers.axis * 3 + numbers.channel != at.technique) return {};
  const double pick = (at.hit + e.gamma_2) / hits;

  ProbeHits seen;
  scene.trace_probe(scene.of, probe_of(to, numbers), to.medium, seen);
  if (seen.count == 0) return {};
  const uint32_t index = picked_hit(pick, seen.count);
  const ProbeHit& hit = seen.hit[index];
  const SurfacePoint y2 = scene.surface_at(scene.of, hit.instance, hit.primitive, hit.barycentrics);
  if (!image)
    image = Place{hit.instance, hit.primitive, at.technique, index, y2.position, y2.normal};
  if (image->instance != hit.instance || image->primitive != hit.primitive || image->hit != index)
    return {};
  double before = 0;
  for (uint32_t t = 0; t < at.technique; ++t)
    before += technique_pdf(to, t, y2.position, y2.normal);
  const double mine = technique_pdf(to, at.technique, y2.position, y2.normal);
  const auto image_axes = along(image->normal);
  const Vector3 moved = y2.position - image->position;
  return Extended{dot(moved, image_axes[0]), dot(moved, image_axes[1]),
                  (before + u * mine) / probe_pdf(to, y2.position, y2.normal),
                  pick * seen.count - index};
}

struct Pairs {
  TriangleScene ear = testing::ear_scene();
  Scene scene = ear.access();
  std::vector<testing::Pixel> pixels = testing::look_at(ear, 40, 40);
  Random random{17, 0, 0};

  // Samples two pixels of one medium, up to 3 apart.
  bool next(Domain& from, Domain& to) {
    const auto below = [&](int n) { return static_cast<int>(random_unit(random) * n); };
    const int x = below(40), y = below(40), u = x + below(7) - 3, v = y + below(7) - 3;
    if (u < 0 || v < 0 || u >= 40 || v >= 40) return false;
    from = pixels[static_cast<size_t>(y * 40 + x)].domain;
    to = pixels[static_cast<size_t>(v * 40 + u)].domain;
    return from.medium != 0 && from.medium == to.medium;
  }
};

TEST(Jacobian, RandomReplay_MatchesFiniteDifferences) {
  Pairs pairs;
  const Scene& scene = pairs.scene;
  int judged = 0, other_hits = 0;
  for (int i = 0; i < 30000 && judged < 1500; ++i) {
    Domain from, to;
    if (!pairs.next(from, to)) continue;
    Random& random = pairs.random;
    const ProbeNumbers numbers = draw_numbers(from.d, {random_unit(random), random_unit(random),
                                                       random_unit(random), random_unit(random)});
    ProbeHits hits;
    scene.trace_probe(scene.of, probe_of(from, numbers), from.medium, hits);
    if (hits.count == 0) continue;
    Place at;
    at.hit = picked_hit(numbers.pick, hits.count);
    const ProbeHit& hit = hits.hit[at.hit];
    const SurfacePoint x2 =
        scene.surface_at(scene.of, hit.instance, hit.primitive, hit.barycentrics);
    at = {hit.instance, hit.primitive, numbers.axis * 3 + numbers.channel,
          at.hit,       x2.position,   x2.normal};
    // Close to x1 the profile changes within a step, and grazing faces magnify the change.
    if (length(x2.position - from.position) < 0.05) continue;
    double below = 0;
    for (uint32_t t = 0; t < at.technique; ++t)
      below += probe_technique_pdf(from, t / 3, t % 3, x2.position, x2.normal);
    const double own =
        probe_technique_pdf(from, numbers.axis, numbers.channel, x2.position, x2.normal);
    const double density = probe_pdf(from, x2.position, x2.normal);
    const Extended middle = {0, 0, (below + random_unit(random) * own) / density,
                             numbers.pick * hits.count - at.hit};
    std::optional<Place> image;
    if (!replayed(scene, from, to, at, middle, hits.count, image)) continue;
    if (length(image->position - to.position) < 0.05) continue;
    if (std::abs(dot(image->normal, probe_axis(to.normal, numbers.axis))) < 0.05) continue;
    std::array<std::array<double, 4>, 4> rows{};
    bool good = true;
    for (size_t k = 0; k < 4 && good; ++k) {
      Extended more = middle, less = middle;
      double Extended::*const members[] = {&Extended::a, &Extended::b, &Extended::gamma_1,
                                           &Extended::gamma_2};
      more.*members[k] += h;
      less.*members[k] -= h;
      const auto up = replayed(scene, from, to, at, more, hits.count, image);
      const auto down = replayed(scene, from, to, at, less, hits.count, image);
      good = up && down;
      if (!good) break;
      rows[k] = {(up->a - down->a) / (2 * h), (up->b - down->b) / (2 * h),
                 (up->gamma_1 - down->gamma_1) / (2 * h), (up->gamma_2 - down->gamma_2) / (2 * h)};
    }
    if (!good) continue; // A step left the face or the choice.

    Reservoir path;
    path.instance = hit.instance;
    path.primitive = hit.primitive;
    path.barycentrics = hit.barycentrics;
    path.numbers = numbers;
    path.hits = hits.count;
    path.density = density;
    path.weight = 1;
    const Shifted shifted = shift_path(scene, Shift::delayed, from, to, path);
    ASSERT_EQ(shifted.path.primitive, image->primitive);
    EXPECT_NEAR(determinant(rows, 4) / shifted.jacobian, 1, 1e-4);
    other_hits += shifted.path.hits != path.hits;
    ++judged;
  }
  EXPECT_GE(judged, 1000);
  EXPECT_GT(other_hits, 10);
}

TEST(Jacobian, Reconnection_MatchesFiniteDifferences) {
  Random random{19, 0, 0};
  const auto number = [&] { return 4 * random_unit(random) - 2; };
  for (int i = 0; i < 1000; ++i) {
    const Vector3 x = {number(), number(), 3 + number() / 2},
                  y = {number(), number(), 3 + number() / 2};
    const Vector3 v = {number(), number(), 0},
                  normal = normalize(Vector3{number() / 8, number() / 8, 1});
    const Vector3 from = normalize(v - x), to = normalize(v - y);
    if (std::abs(dot(from, normal)) < 0.2 || std::abs(dot(to, normal)) < 0.2) continue;
    std::array<std::array<double, 4>, 4> rows{};
    for (size_t k = 0; k < 2; ++k) {
      std::array<Vector3, 2> ends;
      for (const double sign : {-1.0, 1.0}) {
        const Vector3 direction = normalize(from + sign * h * along(from)[k]);
        // Distance to the plane of v.
        const double way = dot(v - x, normal) / dot(direction, normal);
        ends[sign > 0] = normalize(x + way * direction - y);
      }
      for (size_t j = 0; j < 2; ++j)
        rows[k][j] = dot(ends[1] - ends[0], along(to)[j]) / (2 * h);
    }
    EXPECT_NEAR(determinant(rows, 2) / reconnection_jacobian(x, y, v, normal), 1, 1e-4);
  }
}

// Returns samples of a pixel, with and without random numbers.
std::vector<Reservoir> samples_of(const Scene& scene, const Domain& domain, Random& random) {
  std::vector<Reservoir> samples;
  for (int i = 0; i < 4; ++i) {
    const Reservoir candidate = draw_initial(scene, domain, random);
    if (!has_sample(candidate)) continue;
    samples.push_back(candidate);
    Reservoir forgotten = candidate;
    forgotten.hits = 0;
    samples.push_back(forgotten);
  }
  return samples;
}

TEST(Shift, InverseIsTheIdentity) {
  Pairs pairs;
  const Scene& scene = pairs.scene;
  for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid}) {
    int judged = 0, replayed_paths = 0;
    for (int i = 0; i < 6000; ++i) {
      Domain from, to;
      if (!pairs.next(from, to)) continue;
      for (Reservoir path : samples_of(scene, from, pairs.random)) {
        prepare(scene, shift, Index::traced, from, path, pairs.random);
        const Shifted there = shift_path(scene, shift, from, to, path);
        if (there.jacobian == 0) continue;
        Reservoir image = there.path;
        if (shift != Shift::delayed) prepare(scene, shift, Index::traced, to, image, pairs.random);
        const Shifted back = shift_path(scene, shift, to, from, image);
        // Within 1e-9 of an edge, rounding decides which of two faces is hit.
        const Barycentrics& b = path.barycentrics;
        if (std::min({b[0], b[1], 1 - b[0] - b[1]}) < 1e-9) continue;
        ASSERT_GT(back.jacobian, 0) << static_cast<int>(shift);
        EXPECT_EQ(back.path.instance, path.instance);
        EXPECT_EQ(back.path.primitive, path.primitive);
        const SurfacePoint x2 =
            scene.surface_at(scene.of, path.instance, path.primitive, path.barycentrics);
        const SurfacePoint y2 = scene.surface_at(scene.of, back.path.instance, back.path.primitive,
                                                 back.path.barycentrics);
        EXPECT_LT(length(x2.position - y2.position), 1e-6);
        EXPECT_NEAR(there.jacobian * back.jacobian, 1, 1e-6);
        replayed_paths += there.path.hits > 0;
        ++judged;
      }
    }
    EXPECT_GT(judged, 500) << static_cast<int>(shift);
    if (shift == Shift::hybrid) { // The hybrid shift used both replay and reconnection.
      EXPECT_GT(replayed_paths, judged / 20);
      EXPECT_LT(replayed_paths, judged - judged / 20);
    }
  }
}

TEST(Shift, NoImage_JacobianIsZeroAndNeverNaN) {
  Pairs pairs;
  const Scene& scene = pairs.scene;
  Domain from, to;
  std::vector<Reservoir> samples;
  while (samples.empty())
    if (pairs.next(from, to)) samples = samples_of(scene, from, pairs.random);
  const Reservoir good = samples[0];

  Domain other = to, far = to, opaque = to, broken = to;
  other.medium = 3 - to.medium;
  far.position = {1000, 1000, 1000};
  opaque.d = {0, 0, 0};
  broken.position[1] = std::nan("");
  for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid}) {
    EXPECT_EQ(shift_path(scene, shift, from, other, good).jacobian, 0);
    EXPECT_EQ(shift_path(scene, shift, from, to, Reservoir{}).jacobian, 0);
    for (const Domain& bad : {far, opaque, broken}) {
      const Shifted shifted = shift_path(scene, shift, from, bad, good);
      EXPECT_FALSE(shifted.target * shifted.jacobian > 0) << static_cast<int>(shift);
      EXPECT_TRUE(std::isfinite(shifted.jacobian));
      // A merge with such a pixel keeps its own sample with a finite weight.
      const ReuseSettings settings{shift, Index::traced, confidence_cap};
      const Reservoir merged = merge_temporal(scene, settings, from, good, bad, good, pairs.random);
      EXPECT_TRUE(std::isfinite(merged.weight));
      EXPECT_TRUE(std::isfinite(luminance(resolve(scene, from, merged))));
    }
  }
  Reservoir zero = good;
  zero.density = 0;
  zero.hits = 1;
  EXPECT_EQ(shift_path(scene, Shift::delayed, from, to, zero).jacobian, 0);
  EXPECT_EQ(replay_jacobian(1, 1, 0, 1), 0);
  EXPECT_EQ(replay_jacobian(1, 0, 1, 1), 0);
  EXPECT_EQ(replay_jacobian(1e300, 1, 1e-300, 1), 0);
  EXPECT_EQ(reconnection_jacobian({0, 0, 1}, {0, 1, 1}, {0, 0, 1}, {0, 0, 1}), 0);
}

TEST(Shift, SequenceReconnectsFirstAndReplaysLast) {
  EXPECT_EQ(shift_of_stage(Shift::sequential, Stage::temporal), Shift::reconnection);
  EXPECT_EQ(shift_of_stage(Shift::sequential, Stage::spatial_first), Shift::reconnection);
  EXPECT_EQ(shift_of_stage(Shift::sequential, Stage::spatial_second), Shift::delayed);
  for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid})
    EXPECT_EQ(shift_of_stage(shift, Stage::spatial_second), shift);
}

} // namespace
} // namespace dermis::restir
