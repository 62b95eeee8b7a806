#include "tests/passes/restir/sequence.hpp"

#include <algorithm>
#include <utility>

namespace dermis::restir::testing {

namespace {

struct Frame {
  std::vector<Pixel> pixels;
  std::vector<Reservoir> reservoirs;
};

// Returns `pixel` moved by (x, y), or no_pixel outside of the picture or on another medium.
const uint32_t no_pixel = 0xffffffff;
uint32_t moved(const SequenceSettings& s, const Frame& frame, uint32_t medium, uint32_t pixel,
               int x, int y) {
  const int u = static_cast<int>(pixel % s.width) + x, v = static_cast<int>(pixel / s.width) + y;
  if (u < 0 || v < 0 || u >= static_cast<int>(s.width) || v >= static_cast<int>(s.height))
    return no_pixel;
  const uint32_t other = static_cast<uint32_t>(v) * s.width + static_cast<uint32_t>(u);
  return frame.pixels[other].domain.medium == medium ? other : no_pixel;
}

std::vector<Reservoir> spatial_pass(const Scene& scene, const SequenceSettings& s,
                                    const ReuseSettings& reuse, const Frame& frame,
                                    uint32_t neighbours, uint32_t stage, uint32_t key) {
  std::vector<Reservoir> result(frame.pixels.size());
  for (uint32_t i = 0; i < frame.pixels.size(); ++i) {
    const Domain& domain = frame.pixels[i].domain;
    if (domain.medium == 0) continue;
    Random random{i, key, stage * random_numbers_a_pass};
    const double radius =
        std::min(search_radius(domain.d, pixel_footprint(s.width)), s.width / 4.0);
    std::vector<uint32_t> others;
    double confidences = 0;
    for (uint32_t n = 0; n < neighbours; ++n) {
      const auto [x, y] = neighbour_offset(radius, random);
      const uint32_t other = moved(s, frame, domain.medium, i, x, y);
      if (other == no_pixel || other == i) continue;
      others.push_back(other);
      confidences += frame.reservoirs[other].confidence;
    }
    Spatial spatial = spatial_begin(scene, reuse, domain, frame.reservoirs[i], confidences, random);
    for (const uint32_t other : others)
      spatial_add(scene, reuse, domain, spatial, frame.pixels[other].domain,
                  frame.reservoirs[other], random);
    result[i] = spatial_end(spatial, random);
  }
  return result;
}

} // namespace

SequenceResult run_sequence(const TriangleScene& triangles, const SequenceSettings& s,
                            const Regions& regions, const std::vector<double>& reference,
                            uint32_t seed, const std::vector<Light>& lights) {
  Scene scene = triangles.access();
  SequenceResult result;
  result.region_mean.assign(regions.pixels.size(), 0);
  const std::vector<Pixel> views[] = {look_at(triangles, s.width, s.height),
                                      look_at(triangles, s.width, s.height, s.jitter)};
  Frame frame, before;
  double judged = 0;
  const bool over_time = (static_cast<uint32_t>(s.reuse) & 1u) != 0,
             over_space = (static_cast<uint32_t>(s.reuse) & 2u) != 0;
  for (uint32_t f = 0; f < s.frames; ++f) {
    const uint32_t key = seed << 12 | f;
    scene.previous_lights = {};
    if (!lights.empty() && f == s.judged_from)
      scene.previous_lights = std::exchange(scene.lights, std::span<const Light>(lights));
    const bool odd = f % 2 == 1 && s.jitter != 0;
    frame.pixels = views[odd];
    frame.reservoirs.assign(frame.pixels.size(), {});
    const auto settings = [&](Stage stage) {
      return ReuseSettings{shift_of_stage(s.shift, stage), s.index, confidence_cap};
    };
    for (uint32_t i = 0; i < frame.pixels.size(); ++i) {
      const Domain& domain = frame.pixels[i].domain;
      if (domain.medium == 0) continue;
      Random random{i, key, 0};
      frame.reservoirs[i] = draw_initial(scene, domain, random);
      if (!over_time || f == 0) continue;
      const uint32_t past = moved(s, before, domain.medium, i, 0, 0);
      random.count = random_numbers_a_pass;
      if (past != no_pixel)
        frame.reservoirs[i] =
            merge_temporal(scene, settings(Stage::temporal), domain, frame.reservoirs[i],
                           before.pixels[past].domain, before.reservoirs[past], random);
    }
    // The next frame keeps the temporal result without neighbours, in packed form.
    Frame kept = frame;
    for (Reservoir& reservoir : kept.reservoirs)
      reservoir = unpack_reservoir(pack_reservoir(reservoir));
    if (over_space) {
      frame.reservoirs =
          spatial_pass(scene, s, settings(Stage::spatial_first), frame, s.neighbours[0], 2, key);
      frame.reservoirs =
          spatial_pass(scene, s, settings(Stage::spatial_second), frame, s.neighbours[1], 3, key);
    }
    if (!odd && f >= s.judged_from) {
      judged += 1;
      const auto estimate = [&](uint32_t i) {
        return luminance(resolve(scene, frame.pixels[i].domain, frame.reservoirs[i]));
      };
      for (size_t r = 0; r < regions.pixels.size(); ++r)
        for (const uint32_t i : regions.pixels[r])
          result.region_mean[r] += estimate(i) / double(regions.pixels[r].size());
      result.last_square = 0;
      for (uint32_t i = 0; i < reference.size(); ++i)
        result.last_square +=
            (estimate(i) - reference[i]) * (estimate(i) - reference[i]) / double(reference.size());
    }
    before = std::move(kept);
  }
  for (double& mean : result.region_mean)
    mean /= judged;
  return result;
}

} // namespace dermis::restir::testing
