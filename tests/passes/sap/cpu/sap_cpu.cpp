#include "tests/passes/sap/cpu/sap_cpu.hpp"

#include "passes/common/pass_types.hpp"
#include "passes/common/reference/parallel.hpp"
#include "tests/passes/sap/cpu/sap_levels.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

namespace {

// Below these fractions the tent is not worth its reads (level 0, coarser levels).
constexpr double min_fraction_fine = 0.002, min_fraction_coarse = 0.004;

template <class Real> using Color = std::array<Real, 3>;

// Scattered light of a level and all coarser levels, the fraction of the kernel that met the
// surface, and the confidence: the fraction of the surface around that the levels represent.
template <class Real> struct Scattered {
  Color<Real> light{}, mass{};
  Real confidence = 0;
};

template <class Real> struct SapClimb {
  const ReferenceInput& input;
  std::span<const float> table;
  SapVariant variant;
  SapPyramid<Real> pyramid;
  std::array<std::vector<std::vector<Scattered<Real>>>, 2> scattered{}; // By layer and level.

  // Returns the smaller of the distances from the tangent plane and in depth, in metres.
  Real off_plane(const SapTexel<Real>& own, const SapTexel<Real>& tap, Real x, Real y) const {
    const Real step = tap.depth - own.depth;
    return sap_nearer(step - pyramid.rise(own, x, y), step);
  }
  // Returns the same distance between two tangent planes.
  Real off_planes(const SapTexel<Real>& own, const SapTexel<Real>& tap, Real x, Real y) const {
    return sap_nearer(off_plane(own, tap, x, y), tap.depth - own.depth - pyramid.rise(tap, x, y));
  }
  // Returns the layer of a texel that is nearer, the first if equal, or 2 if none has the profile.
  template <class Off>
  static size_t nearer_layer(const SapLevel<Real>& level, int x, int y, uint8_t id, Off off) {
    const SapTexel<Real>*first = level.find(0, x, y, id), *second = level.find(1, x, y, id);
    if (!first) return second ? 1 : 2;
    return second && off(*second) < off(*first) ? 1 : 0;
  }

  Scattered<Real> tent(size_t l, int x, int y, const SapTexel<Real>& own) const {
    const SapLevel<Real>& level = pyramid.levels[l];
    const auto across = pyramid.grid.shape.tent(pyramid.grid.axis(0), uint32_t(l)),
               down = pyramid.grid.shape.tent(pyramid.grid.axis(1), uint32_t(l));
    const int rx = across[2] > 0 ? 2 : 1, ry = down[2] > 0 ? 2 : 1;
    const Real per_sigma = 1 / (Real(sap_sigma) * level.spacing),
               per_metre = per_sigma / pyramid.footprint(own.depth);
    Color<Real> sum{};
    Real total = 0, mass = 0, all_weight = 0;
    for (int j = -ry; j <= ry; ++j)
      for (int i = -rx; i <= rx; ++i) {
        const Real ox = Real(i) * level.spacing_x, oy = Real(j) * level.spacing_y;
        const Real tilt = own.slope(ox, oy) * per_sigma;
        Real weight = Real(16 * across[size_t(std::abs(i))] * down[size_t(std::abs(j))]) *
                      sap_falloff(tilt, sap_tilt_width_tent);
        all_weight += weight;
        const auto off = [&](const SapTexel<Real>& tap) { return off_plane(own, tap, ox, oy); };
        const size_t layer = nearer_layer(level, x + i, y + j, own.id, off);
        if (layer == 2) continue;
        const SapTexel<Real>* tap = level.find(layer, x + i, y + j, own.id);
        weight *= sap_falloff(off(*tap) * per_metre, sap_depth_width) * tap->mass;
        mass += weight;
        total += weight * tap->area;
        for (size_t c = 0; c < 3; ++c)
          sum[c] += weight * tap->area * tap->light[c];
      }
    Scattered<Real> result;
    for (size_t c = 0; c < 3; ++c)
      result.light[c] = sum[c] / total;
    result.mass.fill(mass / all_weight);
    return result;
  }

  Scattered<Real> from_coarser(size_t fine, int x, int y, const SapTexel<Real>& own,
                               const Color<Real>& fallback) const {
    const SapLevel<Real>& coarse = pyramid.levels[fine + 1];
    const Real spacing = pyramid.levels[fine].spacing, spacing_x = pyramid.levels[fine].spacing_x,
               spacing_y = pyramid.levels[fine].spacing_y;
    const bool halves_x = pyramid.grid.halves(0, fine + 1),
               halves_y = pyramid.grid.halves(1, fine + 1);
    const Real per_metre = 1 / (Real(sap_sigma) * spacing * pyramid.footprint(own.depth));
    const double width =
        spacing < Real(sap_first_wide_spacing) ? sap_depth_width : sap_depth_width_up;
    const PerChannel& d = input.d_m[own.id];
    const Real relevant_d = Real(*std::max_element(d.begin(), d.end())) * own.reach;
    Scattered<Real> result;
    Color<Real> sum{};
    Real existing = 0;
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) {
        if ((i > 0 && !halves_x) || (j > 0 && !halves_y)) continue;
        const int qx = halves_x ? ((x - 1) >> 1) + i : x, qy = halves_y ? ((y - 1) >> 1) + j : y;
        const Real ox = halves_x ? (Real(2 * qx - x) + Real(.5)) * spacing_x : Real(0),
                   oy = halves_y ? (Real(2 * qy - y) + Real(.5)) * spacing_y : Real(0);
        const Real bilinear = (halves_x ? Real(std::abs(ox) < spacing_x ? .75 : .25) : Real(1)) *
                              (halves_y ? Real(std::abs(oy) < spacing_y ? .75 : .25) : Real(1));
        const auto off = [&](const SapTexel<Real>& tap) { return off_planes(own, tap, ox, oy); };
        const size_t layer = nearer_layer(coarse, qx, qy, own.id, off);
        if (layer == 2) {
          const SapTexel<Real>* other = coarse.find(0, qx, qy);
          if (other) existing += bilinear * other->lost;
          continue;
        }
        const SapTexel<Real>* tap = coarse.find(layer, qx, qy, own.id);
        const Real step = tap->depth - own.depth;
        const Real kept = sap_falloff(off(*tap) * per_metre, width);
        const Real further = std::max(std::abs(step - pyramid.rise(own, ox, oy)),
                                      std::abs(step - pyramid.rise(*tap, ox, oy)));
        const Scattered<Real>& theirs = scattered[layer][fine + 1][coarse.index(qx, qy)];
        for (size_t c = 0; c < 3; ++c) {
          const Real mass = bilinear * kept * theirs.mass[c];
          result.mass[c] += mass;
          sum[c] += mass * theirs.light[c];
        }
        const Real strictly = sap_falloff(further * per_metre, sap_confidence_width);
        const Real lost =
            (1 - strictly) * std::max(sap_relevance(off(*tap), relevant_d), 1 - tap->held);
        existing += bilinear;
        result.confidence += bilinear * (1 - lost) * theirs.confidence;
      }
    result.confidence = existing > Real(1e-6) ? result.confidence / existing : Real(1);
    for (size_t c = 0; c < 3; ++c) {
      const bool found = result.mass[c] > Real(sap_negligible);
      result.light[c] = found ? sum[c] / result.mass[c] : fallback[c];
    }
    return result;
  }

  Scattered<Real> climb(size_t l, int x, int y, const SapTexel<Real>& own) const {
    const PerChannel& d = input.d_m[own.id];
    const size_t widest = static_cast<size_t>(std::max_element(d.begin(), d.end()) - d.begin());
    const bool last = l + 1 == sap_level_count;
    Color<Real> centre{}, fraction{};
    for (size_t c = 0; c < 3; ++c) {
      Real d_px = Real(d[c]) * own.reach / pyramid.footprint(own.depth);
      if (l == 0) d_px /= std::sqrt(own.area);
      if (l == 0) centre[c] = sap_lookup<Real>(table, 0, d_px);
      fraction[c] = last ? Real(1) : sap_lookup<Real>(table, static_cast<uint32_t>(l + 1), d_px);
    }
    Scattered<Real> here{own.light, {own.mass, own.mass, own.mass}, 0};
    const Real minimum = Real(l == 0 ? min_fraction_fine : min_fraction_coarse);
    if (l <= sap_last_tent(variant) &&
        *std::max_element(fraction.begin(), fraction.end()) >= minimum)
      here = tent(l, x, y, own);
    const Scattered<Real> rest =
        last ? Scattered<Real>{here.light, {}, 1} : from_coarser(l, x, y, own, here.light);
    Scattered<Real> result;
    for (size_t c = 0; c < 3; ++c) {
      const Real near = centre[c] * own.mass, mid = fraction[c] * here.mass[c],
                 far = std::max(1 - centre[c] - fraction[c], Real(0)) * rest.mass[c];
      const Real total = near + mid + far, scale = 1 / std::max(total, Real(sap_negligible));
      const Real mean = rest.light[c] + near * scale * (own.light[c] - rest.light[c]) +
                        mid * scale * (here.light[c] - rest.light[c]);
      result.light[c] = std::max(mean, Real(0)); // Differences may round below zero.
      result.mass[c] = total;
    }
    const Real near = centre[widest] + fraction[widest];
    result.confidence = near * own.held + (1 - near) * rest.confidence;
    return result;
  }
};

} // namespace

template <class Real>
SapResult<Real> sap_scatter(const ReferenceInput& input, std::span<const float> table,
                            const SapOptions& options) {
  SapClimb<Real> climb{
      input, table, options.variant,
      build_sap_pyramid<Real>(input, options.first_layered, options.threads, options.grid)};
  for (auto& levels : climb.scattered)
    levels.resize(sap_level_count);
  for (size_t l = sap_level_count; l-- > 0;) {
    const SapLevel<Real>& level = climb.pyramid.levels[l];
    for (size_t layer = 0; layer < level.layers.size(); ++layer)
      climb.scattered[layer][l].resize(level.layers[layer].size());
    parallel_for(static_cast<size_t>(level.height + 2 * level.border), 4, options.threads,
                 [&](size_t row) {
                   const int y = static_cast<int>(row) - level.border;
                   for (int x = -level.border; x < level.width + level.border; ++x)
                     for (size_t layer = 0;
                          layer < level.layers.size() && !level.layers[layer].empty(); ++layer) {
                       const SapTexel<Real>& own = level.layers[layer][level.index(x, y)];
                       if (own.id != 0)
                         climb.scattered[layer][l][level.index(x, y)] = climb.climb(l, x, y, own);
                     }
                 });
  }
  SapResult<Real> result{{input.light.begin(), input.light.end()},
                         std::vector<Real>(size_t{input.width} * input.height, 1)};
  for (size_t i = 0; i < result.confidence.size(); ++i) {
    const SapTexel<Real>& own = climb.pyramid.levels[0].layers[0][i];
    if (own.id == 0) continue;
    const PerChannel& d = input.d_m[own.id];
    const double widest = *std::max_element(d.begin(), d.end());
    const double scale =
        input.scatter_scale.empty() ? 1.0 : double(std::max(0.0f, input.scatter_scale[i]));
    if (widest * scale < copy_below_d_px * double(climb.pyramid.smallest_side(own.depth))) continue;
    for (size_t c = 0; c < 3; ++c)
      if (d[c] > 0) result.light[3 * i + c] = climb.scattered[0][0][i].light[c];
    result.confidence[i] = climb.scattered[0][0][i].confidence;
  }
  return result;
}
template SapResult<float> sap_scatter<float>(const ReferenceInput&, std::span<const float>,
                                             const SapOptions&);
template SapResult<double> sap_scatter<double>(const ReferenceInput&, std::span<const float>,
                                               const SapOptions&);

} // namespace dermis::subsurface
