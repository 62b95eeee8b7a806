// Compares the GLSL of ReSTIR on a device with the CPU functions in fp64, for equal inputs and
// random bits.
#include "tests/passes/restir/cpu/reuse.hpp"
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_restir.spv.h"

#include <algorithm>
#include <bit>
#include <tuple>

namespace dermis::restir {
namespace {

constexpr uint32_t cases = 512, rows = 40;
// fp32 has a relative step of 6e-8. Results of a few operations with the driver's exp and log
// (within 1e-6) agree to 1e-5; positions and offsets lose a factor of up to their size over the
// distance.
constexpr double relative = 1e-5;

// The sheets of test_restir.comp.
constexpr double sheets[] = {0, -0.4, -1}, sheet_size = 64;
constexpr uint32_t sheet_instance = 16777217;

void trace_sheets(const void*, const ProbeRay& ray, uint32_t, ProbeHits& hits) {
  hits.count = 0;
  for (uint32_t i = 0; i < 3; ++i) {
    const uint32_t sheet = ray.direction[2] < 0 ? i : 2 - i;
    const double way = (sheets[sheet] - ray.origin[2]) / ray.direction[2];
    if (!(way > 0 && way < ray.length)) continue;
    const Vector3 place = ray.origin + way * ray.direction;
    hits.hit[hits.count++] = {sheet_instance + sheet,
                              0xfffffff0,
                              {place[0] / sheet_size + 0.5, place[1] / sheet_size + 0.5},
                              way};
  }
}
SurfacePoint point_on_sheet(const void*, uint32_t instance, uint32_t, const Barycentrics& b) {
  const Vector3 up = {0, 0, instance == sheet_instance ? 1.0 : -1.0};
  return {{(b[0] - 0.5) * sheet_size, (b[1] - 0.5) * sheet_size, sheets[instance - sheet_instance]},
          up,
          up,
          1};
}
bool seen_from_sheet(const void*, const SurfacePoint& from, const Vector3& to) {
  return from.position[0] * to[0] < 9;
}
const Light sheet_lights[] = {
    {{3, 2, 5}, LightType::point, {}, 0.5, {}, 1, {8, 9, 10}, 0.5},
    {{1, 1, -4}, LightType::parallelogram, {2, 0, 0}, 0.5, {0, 2, 0}, 4, {4, 3, 2}, 1},
};
// Each light moved and changed its colour.
const Light sheet_lights_before[] = {
    {{2.5, 2, 5}, LightType::point, {}, 0.5, {}, 1, {10, 8, 9}, 0.5},
    {{0.5, 1, -4}, LightType::parallelogram, {2, 0, 0}, 0.5, {0, 2, 0}, 4, {2, 4, 3}, 1},
};
const Scene sheet_scene = {nullptr,         trace_sheets, point_on_sheet,
                           seen_from_sheet, sheet_lights, sheet_lights_before};

Vector3 three(Random& random) {
  Vector3 v;
  for (double& one : v)
    one = random_unit(random);
  return v;
}
Domain pixel_on_sheet(Random& random) {
  const Vector3 at = three(random), tilt = three(random);
  return {{4 * at[0] - 2, 4 * at[1] - 2, 0},
          normalize(Vector3{tilt[0] - 0.5, tilt[1] - 0.5, 0.5}),
          {1, 0.5, 0.25},
          1};
}

class RestirKernel : public dermis::testing::KernelTest {
protected:
  void SetUp() override {
    KernelTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    if (answers.empty()) answers = answers_of({"test_restir", test_restir_spirv}, cases, rows);
  }

  double at(uint32_t x, uint32_t row, size_t channel) const {
    return double(answers[4 * (size_t{row} * cases + x) + channel]);
  }
  Vector3 three_at(uint32_t x, uint32_t row, size_t first = 0) const {
    return {at(x, row, first), at(x, row, first + 1), at(x, row, first + 2)};
  }

  // The inputs of case x.
  struct Question {
    Domain domain;
    Vector3 x2{}, n2{};
    std::array<double, 4> u{};
    double u_invert = 0;
    Light light;
    uint32_t place = 0;
  };
  Question question(uint32_t x) const {
    Question q;
    q.domain = {three_at(x, 0), three_at(x, 1), {at(x, 0, 3), at(x, 1, 3), at(x, 2, 3)}, 1};
    q.x2 = three_at(x, 2);
    q.n2 = three_at(x, 3);
    q.u_invert = at(x, 3, 3);
    q.u = {at(x, 4, 0), at(x, 4, 1), at(x, 4, 2), at(x, 4, 3)};
    q.light.type = static_cast<LightType>(x % 4);
    q.light.position = three_at(x, 5);
    q.light.edge_u = {at(x, 5, 3), at(x, 6, 0), at(x, 6, 1)};
    q.light.edge_v = {at(x, 6, 2), at(x, 6, 3), at(x, 7, 0)};
    q.light.emission = three_at(x, 7, 1);
    q.light.area = at(x, 8, 0);
    q.light.fraction = at(x, 8, 1);
    q.place = static_cast<uint32_t>(at(x, 8, 2)) | static_cast<uint32_t>(at(x, 8, 3)) << 16;
    return q;
  }

  void expect_near(uint32_t x, uint32_t row, const std::array<double, 4>& reference, double scale,
                   double tolerance) const {
    for (size_t c = 0; c < 4; ++c)
      EXPECT_NEAR(at(x, row, c), reference[c], tolerance * std::max(std::abs(reference[c]), scale))
          << "case " << x << ", row " << row << ", channel " << c;
  }

  static inline std::vector<float>
      // Cached, because the kernel takes longer to compile than all tests take to check its output.
      answers;
};

TEST_F(RestirKernel, ProbesAreEqual) {
  ASSERT_FALSE(answers.empty());
  for (uint32_t x = 0; x < cases; ++x) {
    const Question q = question(x);
    const ProbeNumbers numbers = draw_numbers(q.domain.d, q.u);
    const ProbeRay ray = probe_of(q.domain, numbers);
    expect_near(x, 9,
                {double(numbers.axis), double(numbers.channel), numbers.survival, numbers.angle}, 0,
                relative);
    // Positions are sums of parts as long as the reach.
    expect_near(x, 10, {ray.origin[0], ray.origin[1], ray.origin[2], ray.length},
                scattering_reach(q.domain.d), relative);
    expect_near(
        x, 11,
        {ray.direction[0], ray.direction[1], ray.direction[2], double(picked_hit(numbers.pick, 5))},
        1, relative);
    const Vector3 tangent = probe_axis(q.domain.normal, 1);
    expect_near(x, 16,
                {tangent[0], tangent[1], tangent[2], search_radius(q.domain.d, 0.05 * q.u[0])}, 1,
                relative);
  }
}

TEST_F(RestirKernel, ProfileAndDensityAreEqual) {
  ASSERT_FALSE(answers.empty());
  for (uint32_t x = 0; x < cases; ++x) {
    const Question q = question(x);
    const double r = length(q.x2 - q.domain.position);
    const Vector3 profile = scattering_profile(q.domain.d, r);
    // Offsets of length r have errors of 1e-7 r. Close to an axis the disc's radius is shorter and
    // R is steeper.
    expect_near(x, 12, {profile[0], profile[1], profile[2], probe_pdf(q.domain, q.x2, q.n2)}, 1e-12,
                5 * relative);
  }
}

TEST_F(RestirKernel, InvertedNumbersAreEqual) {
  ASSERT_FALSE(answers.empty());
  int same = 0, reached = 0;
  for (uint32_t x = 0; x < cases; ++x) {
    const Question q = question(x);
    ProbeNumbers numbers;
    if (!invert_point(q.domain, q.x2, q.n2, q.u_invert, numbers)) {
      EXPECT_EQ(at(x, 13, 0), -1);
      continue;
    }
    ++reached;
    if (at(x, 13, 0) != numbers.axis || at(x, 13, 1) != numbers.channel)
      continue; // Rounding at the border of a choice.
    ++same;
    EXPECT_NEAR(at(x, 13, 2), numbers.survival, relative);
    const double turn = std::abs(at(x, 13, 3) - numbers.angle);
    EXPECT_LT(std::min(turn, 1 - turn), relative);
  }
  EXPECT_GT(reached, static_cast<int>(cases) / 2);
  EXPECT_GE(same, reached - 1);
}

TEST_F(RestirKernel, LightingIsEqual) {
  ASSERT_FALSE(answers.empty());
  int lit = 0;
  for (uint32_t x = 0; x < cases; ++x) {
    const Question q = question(x);
    const Vector3 shading = normalize(q.n2 + Vector3{0.1, 0.2, 0.3});
    const Vector3 irradiance = light_irradiance(q.light, q.place, q.x2, q.n2, shading);
    const Vector3 target = light_target(q.light, q.place, q.x2);
    lit += luminance(irradiance) > 0;
    const Vector3 way = q.light.type == LightType::directional ? q.light.position : target - q.x2;
    // Cosines are as exact as a difference of positions, up to 8 from the origin; grazing cosines
    // lose digits.
    const double scale =
        length(q.light.emission) / (q.light.type == LightType::directional ? 1 : dot(way, way));
    expect_near(x, 14, {irradiance[0], irradiance[1], irradiance[2], light_density(q.light)}, scale,
                relative);
    expect_near(x, 15, {target[0], target[1], target[2], double(connectable(q.domain, q.x2, q.n2))},
                1, relative);
  }
  EXPECT_GT(lit, static_cast<int>(cases) / 10);
}

TEST_F(RestirKernel, MergedPathsAreEqual) {
  ASSERT_FALSE(answers.empty());
  int same = 0, with_samples = 0, chosen_elsewhere = 0;
  for (uint32_t x = 0; x < cases; ++x) {
    Random random{x, 2, 0};
    const ReuseSettings settings{static_cast<Shift>(x % 3), static_cast<Index>(x / 3 % 2),
                                 confidence_cap};
    const Domain here = pixel_on_sheet(random), there = pixel_on_sheet(random),
                 neighbour = pixel_on_sheet(random);
    const Reservoir own = draw_initial(sheet_scene, here, random);
    Reservoir history = draw_initial(sheet_scene, there, random);
    const Reservoir other = draw_initial(sheet_scene, neighbour, random);
    history.confidence = 30;
    const Reservoir merged =
        merge_temporal(sheet_scene, settings, here, own, there, history, random);
    Spatial spatial = spatial_begin(sheet_scene, settings, here, merged,
                                    history.confidence + other.confidence, random);
    spatial_add(sheet_scene, settings, here, spatial, there, history, random);
    spatial_add(sheet_scene, settings, here, spatial, neighbour, other, random);
    const Reservoir last = spatial_end(spatial, random);
    // A number within rounding of a threshold may decide differently on the device; such cases are
    // counted.
    bool agrees = true;
    const auto compare = [&](uint32_t row, const std::array<double, 4>& reference) {
      for (size_t c = 0; c < 4; ++c)
        agrees = agrees &&
                 std::abs(at(x, row, c) - reference[c]) <= 2e-4 * std::abs(reference[c]) + 1e-7;
    };
    const auto path_of = [&](const Reservoir& r) {
      const double sheet = has_sample(r) ? double(r.instance - (sheet_instance - 1)) : 0;
      return std::array<double, 4>{sheet, r.barycentrics[0], r.barycentrics[1], r.weight};
    };
    const auto light_of = [&](const Reservoir& r) {
      const Vector3 light = resolve(sheet_scene, here, r);
      return std::array<double, 4>{light[0], light[1], light[2], r.confidence};
    };
    compare(17, path_of(own));
    compare(18, {own.irradiance[0], own.irradiance[1], own.irradiance[2], own.density});
    compare(19, path_of(merged));
    compare(20, light_of(merged));
    compare(21, path_of(last));
    compare(22, light_of(last));
    compare(23, {random_unit(random), double(random.count), 0, 0});
    same += agrees;
    with_samples += has_sample(last);
    chosen_elsewhere += has_sample(last) && last.place != own.place;
  }
  EXPECT_GE(same, static_cast<int>(cases) * 98 / 100);
  EXPECT_GT(with_samples, static_cast<int>(cases) / 4);
  EXPECT_GT(chosen_elsewhere, static_cast<int>(cases) / 10);
}

Reservoir packed_case(uint32_t x, const std::array<double, 4>& u, const ProbeNumbers& numbers,
                      const Light& light, uint32_t place) {
  Reservoir r;
  r.instance = (1u << 24) + 1 + x;
  r.primitive = 0xfffffffe - x;
  r.barycentrics = {u[0], u[1]};
  r.light = 0xfedcba98;
  r.place = place;
  r.numbers = numbers;
  r.hits = max_probe_hits;
  r.density = u[2];
  r.irradiance = light.emission;
  r.weight = u[3];
  r.confidence = light.area;
  return r;
}

TEST_F(RestirKernel, PackedWordsAreEqual) {
  ASSERT_FALSE(answers.empty());
  for (uint32_t x = 0; x < cases; ++x) {
    const Question q = question(x);
    ProbeNumbers numbers = draw_numbers(q.domain.d, q.u);
    numbers.survival = at(x, 9, 2); // The device's own rounding.
    const PackedReservoir words = pack_reservoir(packed_case(x, q.u, numbers, q.light, q.place));
    for (uint32_t i = 0; i < 16; ++i) {
      const uint32_t row = 24 + i / 2;
      const size_t first = i % 2 * 2;
      EXPECT_EQ(at(x, row, first), words[i] & 0xffffu) << "case " << x << ", word " << i;
      EXPECT_EQ(at(x, row, first + 1), words[i] >> 16) << "case " << x << ", word " << i;
    }
  }
}

TEST_F(RestirKernel, PackedDomainsAreEqual) {
  ASSERT_FALSE(answers.empty());
  for (uint32_t x = 0; x < cases; ++x) {
    const Domain domain = question(x).domain;
    const PackedDomain words = pack_domain(domain);
    const auto word_of = [&](uint32_t row, size_t first) {
      return static_cast<uint32_t>(at(x, row, first)) | static_cast<uint32_t>(at(x, row, first + 1))
                                                            << 16;
    };
    EXPECT_EQ(word_of(33, 0), words[0]);
    EXPECT_EQ(word_of(33, 2), words[3]);
    EXPECT_EQ(word_of(34, 0), words[4]);
    const Vector3 normal = unpack_domain(words).normal, found = three_at(x, 35);
    // A step of 16 bits where rounding differs.
    EXPECT_LT(length(found - normal), 1e-4) << "case " << x;
    EXPECT_LT(length(found - domain.normal), 1e-4) << "case " << x;
    EXPECT_EQ(at(x, 35, 3), domain.medium);
  }
}

// The hits of find_listed in test_restir.comp.
ProbeHits listed_hits(uint32_t list) {
  std::vector<ProbeHit> all;
  for (uint32_t i = 0; i < list % 25; ++i)
    all.push_back({i % 3, i, {double(i), 0}, double((7 * i + list) % 11)});
  std::sort(all.begin(), all.end(), [](const ProbeHit& a, const ProbeHit& b) {
    return std::tie(a.distance, a.instance, a.primitive) <
           std::tie(b.distance, b.instance, b.primitive);
  });
  ProbeHits hits;
  hits.count = std::min<uint32_t>(max_probe_hits, static_cast<uint32_t>(all.size()));
  std::copy_n(all.begin(), hits.count, hits.hit.begin());
  return hits;
}

TEST_F(RestirKernel, HitsAreFoundByDistance) {
  ASSERT_FALSE(answers.empty());
  uint32_t found_primitives = 0, more_than_limit = 0;
  for (uint32_t x = 0; x < cases; ++x) {
    const ProbeHits hits = listed_hits(x);
    more_than_limit += x % 25 > max_probe_hits;
    EXPECT_EQ(at(x, 37, 0), hits.count);
    EXPECT_EQ(at(x, 38, 0), hits.count);
    if (hits.count == 0) continue;
    const std::array<double, 4> u = question(x).u;
    const uint32_t picked = picked_hit(u[3], hits.count);
    EXPECT_EQ(at(x, 37, 1), picked) << "case " << x;
    EXPECT_EQ(at(x, 37, 2), hits.hit[picked].primitive) << "case " << x;
    EXPECT_EQ(at(x, 37, 3), hits.hit[picked].barycentrics[0]) << "case " << x;
    double pick = 0;
    const auto instance = static_cast<uint32_t>(u[0] * 3),
               primitive = static_cast<uint32_t>(u[1] * 20);
    const bool found = invert_pick(hits, instance, primitive, 0.5, pick);
    found_primitives += found;
    EXPECT_EQ(at(x, 38, 1), found ? picked_hit(pick, hits.count) : hits.count) << "case " << x;
  }
  EXPECT_GT(found_primitives, 50u);
  EXPECT_GT(more_than_limit, 100u);
}

TEST_F(RestirKernel, NeighbourOffsetsMatchTheCpu) {
  ASSERT_FALSE(answers.empty());
  int same = 0;
  for (uint32_t x = 0; x < cases; ++x) {
    Random random{x, 3, 0};
    const auto near = neighbour_offset(5, random), far = neighbour_offset(30, random);
    same += at(x, 36, 0) == near[0] && at(x, 36, 1) == near[1] && at(x, 36, 2) == far[0] &&
            at(x, 36, 3) == far[1];
  }
  EXPECT_GE(same, static_cast<int>(cases) * 99 / 100); // Rounding at a border between pixels.
}

TEST_F(RestirKernel, NaNAndInfinityAreDropped) {
  ASSERT_FALSE(answers.empty());
  constexpr uint32_t spoilt[] = {2, 3, 7, 8, 9, 10, 11, 12, 14, 15};
  constexpr uint32_t bad[] = {0x7fc00000, 0x7f800000, 0xff800000, 0xbf800000}; // NaN, Inf, -Inf, -1
  for (uint32_t x = 0; x < cases; ++x) {
    const Question q = question(x);
    PackedReservoir words =
        pack_reservoir(packed_case(x, q.u, draw_numbers(q.domain.d, q.u), q.light, q.place));
    words[spoilt[x % 10]] = bad[x / 10 % 4];
    const Reservoir r = unpack_reservoir(words);
    expect_near(x, 32, {double(has_sample(r)), r.weight, r.confidence, double(r.hits)}, 0, 0);
  }
}

} // namespace
} // namespace dermis::restir
