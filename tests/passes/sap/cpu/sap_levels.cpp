#include "tests/passes/sap/cpu/sap_levels.hpp"

#include "passes/common/reference/parallel.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

namespace {

constexpr double hysteresis = 1.02; // The first of equal children stays the seed.
// A plane is never extrapolated nearer than this fraction of its depth.
constexpr double nearest_fraction = 0.25;
constexpr size_t children_a_layer = 16, no_child = 2 * children_a_layer;
// Indices of the central children in the first and the second layer.
constexpr size_t central[8] = {5, 6, 9, 10, 21, 22, 25, 26};
// A child that the first layer has used more cannot seed the second layer: it belongs to the bent
// surface of the first layer.
constexpr double max_used_part = 0.27;

// Fraction of a child that counts in the second layer even if the first has used the child.
constexpr double min_shared = 0.25;
// Returns the additional fraction of mass of a child that is parallel to the seed, because the two
// are then separate surfaces. A child on a bend gets none. `bend`: difference of their slopes.
template <class Real> Real parallel_share(Real bend_x, Real bend_y) {
  return std::max(Real(1 - min_shared) - std::abs(bend_x) - std::abs(bend_y), Real(0));
}

// Weight of a child along an axis; an axis that is not halved has one child.
template <class Real> Real binomial(size_t child, bool halves) {
  return halves ? Real(child % 3 == 0 ? .125 : .375) : Real(child == 1 ? 1 : 0);
}

// The 4x4 children of a parent, of both layers, and their positions.
template <class Real> struct Children {
  std::array<const SapTexel<Real>*, no_child> texels{}; // Null: no surface.
  // The part that no layer of the parent has taken yet.
  std::array<Real, no_child> left{};
  Real spacing = 1, spacing_x = 1, spacing_y = 1;
  bool halves_x = true, halves_y = true;

  Real weight(size_t child) const {
    return binomial<Real>(child % 4, halves_x) *
           binomial<Real>(child % children_a_layer / 4, halves_y);
  }
  bool may_seed(size_t child) const {
    return texels[child] && left[child] >= Real(1 - max_used_part) && weight(child) > 0;
  }
  Real x(size_t child) const {
    return halves_x ? (Real(child % 4) - Real(1.5)) * spacing_x : Real(0);
  }
  Real y(size_t child) const {
    return halves_y ? (Real(child % children_a_layer / 4) - Real(1.5)) * spacing_y : Real(0);
  }
};

template <class Real>
SapTexel<Real> plane_at_parent(const SapPyramid<Real>& pyramid, const Children<Real>& children,
                               size_t child) {
  SapTexel<Real> plane = *children.texels[child];
  const Real rise = pyramid.rise(plane, children.x(child), children.y(child));
  plane.depth = std::max(plane.depth - rise, Real(nearest_fraction) * plane.depth);
  return plane;
}

// Returns the child whose plane most of the central children support; without a central child, the
// outer child with the largest weight; no_child if no child is left.
template <class Real>
size_t find_seed(const SapPyramid<Real>& pyramid, const Children<Real>& children) {
  size_t best = no_child;
  Real maximum = 0;
  for (const size_t a : central) {
    if (!children.may_seed(a)) continue;
    const SapTexel<Real> plane = plane_at_parent(pyramid, children, a);
    const Real per_metre =
        1 / (Real(sap_sigma) * children.spacing * pyramid.footprint(plane.depth));
    Real support = 0;
    for (const size_t b : central) {
      const SapTexel<Real>* child = children.texels[b];
      if (!children.may_seed(b) || child->id != plane.id) continue;
      const Real step = child->depth - plane.depth;
      const Real off = sap_nearer(step - pyramid.rise(plane, children.x(b), children.y(b)), step);
      support += sap_falloff(off * per_metre, sap_depth_width);
    }
    if (best == no_child || support > Real(hysteresis) * maximum) {
      best = a;
      maximum = support;
    }
  }
  if (best != no_child) return best;
  for (size_t a = 0; a < no_child; ++a) {
    const Real weight =
        children.may_seed(a) ? children.weight(a) * children.texels[a]->mass : Real(0);
    if (weight > Real(hysteresis) * maximum) {
      best = a;
      maximum = weight;
    }
  }
  return best;
}

// Sums over the children near a layer that determine the mass of a folded surface.
template <class Real> struct Folding {
  Real area_mass = 0; // Mass times the area of the child over its cross-section.
  Real first = 0;     // Weight times mass of the first layer of all children.
  Real rise = 0;      // Mass times the rises of the child and of the seed's plane, in sigmas.

  // Returns the mass of a parent by the area of its children, as sap_mass_by_area() of
  // shaders/sap/sap_folds.glsl. `mass`: of the children; `all_weight`: of a complete plane.
  Real parent_mass(const SapTexel<Real>& seed, const SapTexel<Real>& parent, Real mass,
                   Real all_weight) const {
    // The mean square of a plane's rise in sigmas is the square of its slope.
    const Real plane = std::max(mass * (seed.slope_x * seed.slope_x + seed.slope_y * seed.slope_y),
                                Real(sap_negligible));
    const Real rising = std::clamp(Real(sap_rising) * rise / plane, Real(0), Real(1));
    const Real ratio = area_mass / (mass * parent.slope_area(rising));
    const Real squared = std::min(first * first, Real(1)), covered = squared * squared;
    const Real gain = 1 + (std::pow(ratio, Real(sap_gain_power)) - 1) * covered * covered;
    return std::min(std::min(mass / all_weight, std::max(first, Real(1))) * gain,
                    Real(sap_max_mass));
  }
};

// Builds one layer of a parent, and subtracts the used part from what the children have left. The
// light of a layer is that of all children near its plane, also of those on another layer: both
// surfaces scatter into each other. The plane counts children of the layer before less, and so does
// mass unless they are parallel.
// `mass_by_area`: mass counts area (sap_max_mass). `plane` receives the seed's plane.
template <class Real>
SapTexel<Real> reduce(const SapPyramid<Real>& pyramid, Children<Real>& children, bool mass_by_area,
                      SapTexel<Real>& plane) {
  const size_t seed = find_seed(pyramid, children);
  if (seed == no_child) return {};
  plane = plane_at_parent(pyramid, children, seed);
  const Real per_sigma = 1 / (Real(sap_sigma) * children.spacing);
  const Real per_metre = per_sigma / pyramid.footprint(plane.depth);
  SapTexel<Real> sum;
  Real all_weight = 0, total = 0, flat = 0, light_mass = 0;
  Folding<Real> folds;
  for (size_t k = 0; k < no_child; ++k) {
    const Real x = children.x(k), y = children.y(k);
    const Real tilt = plane.slope(x, y) * per_sigma;
    if (k < children_a_layer)
      all_weight += children.weight(k) * sap_falloff(tilt, sap_tilt_width_down);
    const SapTexel<Real>* child = children.texels[k];
    if (child && k < children_a_layer) folds.first += children.weight(k) * child->mass;
    if (!child || child->id != plane.id || !(children.weight(k) > 0)) continue;
    const Real step = (child->depth - plane.depth) * per_metre;
    const Real off = sap_nearer(step - pyramid.rise(plane, x, y) * per_metre, step);
    const Real narrowing = sap_falloff(sap_nearer(tilt, step), sap_tilt_width_down);
    const Real kept = sap_falloff(off, sap_depth_width);
    const Real near_weight = children.weight(k) * kept * child->mass;
    const Real used = 1 - children.left[k];
    const Real flat_weight = near_weight * (1 - Real(1 - min_shared) * used);
    const Real parallel =
        parallel_share(child->slope_x - plane.slope_x, child->slope_y - plane.slope_y);
    const Real near_mass = flat_weight + near_weight * used * parallel;
    children.left[k] *= 1 - kept;
    const Real weight = near_weight * narrowing * child->area;
    light_mass += near_weight * narrowing;
    const Real mass = near_mass * narrowing;
    sum.mass += mass;
    folds.area_mass += mass * child->slope_area();
    folds.rise += mass * tilt * step;
    total += weight;
    flat += flat_weight;
    for (size_t c = 0; c < 3; ++c)
      sum.light[c] += weight * child->light[c];
    sum.depth += flat_weight * (child->depth - pyramid.rise(*child, x, y));
    sum.slope_x += flat_weight * child->slope_x;
    sum.slope_y += flat_weight * child->slope_y;
    sum.reach += flat_weight * child->reach;
  }
  if (!(total > Real(sap_negligible))) return {};
  SapTexel<Real> parent{.depth = std::max(sum.depth / flat, Real(nearest_fraction) * plane.depth),
                        .slope_x = sum.slope_x / flat,
                        .slope_y = sum.slope_y / flat,
                        .reach = sum.reach / flat,
                        .mass = std::min(Real(1), sum.mass / all_weight),
                        .area = total / light_mass,
                        .light = {},
                        .id = plane.id};
  if (mass_by_area) parent.mass = folds.parent_mass(plane, parent, sum.mass, all_weight);
  for (size_t c = 0; c < 3; ++c)
    parent.light[c] = sum.light[c] / total;
  return parent;
}

// Returns whether a pixel with a surface is next to another surface: one of another profile, or one
// that is far off in depth.
bool is_at_edge(const ReferenceInput& input, const Surface& surface, size_t i) {
  const double z = input.rays.perspective ? input.depth[i] : 1;
  const auto apart = [&](size_t other, double scale) {
    const double step = double(input.depth[other]) - double(input.depth[i]);
    return surface.patches[other].area > 0 &&
           (input.profile[other] != input.profile[i] ||
            std::abs(step) > sap_edge_slope * std::abs(scale) * z);
  };
  const size_t x = i % input.width, y = i / input.width;
  return (x > 0 && apart(i - 1, input.rays.scale_x)) ||
         (x + 1 < input.width && apart(i + 1, input.rays.scale_x)) ||
         (y > 0 && apart(i - input.width, input.rays.scale_y)) ||
         (y + 1 < input.height && apart(i + input.width, input.rays.scale_y));
}

// Sets `held` and `lost` of a parent's layer after all layers have used the children. `ids`:
// profiles of the layers; `d`: of the layer's profile, in metres.
template <class Real>
void set_held(const SapPyramid<Real>& pyramid, const Children<Real>& children,
              const std::array<uint8_t, 2>& ids, Real d, const SapTexel<Real>& plane,
              SapTexel<Real>& parent) {
  Real all = 0, same = 0, held = 0, lost = 0;
  for (size_t k = 0; k < no_child; ++k) {
    const SapTexel<Real>* child = children.texels[k];
    if (!child) continue;
    const Real part = children.weight(k) * child->mass, step = child->depth - plane.depth;
    all += part;
    if (child->id != ids[0] && child->id != ids[1]) lost += part;
    if (child->id != parent.id) continue;
    const Real off = sap_nearer(step - pyramid.rise(plane, children.x(k), children.y(k)), step);
    same += part;
    held += part * child->held * (1 - children.left[k] * sap_relevance(off, d * plane.reach));
  }
  parent.held = same > 0 ? held / same : Real(1);
  parent.lost = all > 0 ? lost / all : Real(0);
}

template <class Real>
SapTexel<Real> first_texel(const ReferenceInput& input, const Patch& patch, size_t i) {
  const double x = double(i % input.width), y = double(i / input.width);
  const Vector3 ray = input.rays.perspective ? pixel_ray(input.rays, x, y) : Vector3{0, 0, -1};
  const double cosine = -dot(patch.normal, ray) / length(ray);
  // The plane dot(normal, P) = const, differentiated by pixel, as in shaders/common/patch.glsl.
  const double turn = input.rays.perspective ? -1 / dot(patch.normal, ray) : 1 / patch.normal[2];
  const double mean = std::sqrt(std::abs(input.rays.scale_x * input.rays.scale_y));
  const double scale =
      input.scatter_scale.empty() ? 1.0 : double(std::max(0.0f, input.scatter_scale[i]));
  return {.depth = Real(input.depth[i]),
          .slope_x = Real(patch.normal[0] * turn * input.rays.scale_x / mean),
          .slope_y = Real(patch.normal[1] * turn * input.rays.scale_y / mean),
          .reach = Real(std::pow(cosine, sap_reach_power) * scale),
          .mass = 1,
          .area = Real(std::pow(cosine, -sap_area_power)),
          .light = {Real(input.light[3 * i]), Real(input.light[3 * i + 1]),
                    Real(input.light[3 * i + 2])},
          .id = input.profile[i]};
}

} // namespace

template <class Real>
SapPyramid<Real> build_sap_pyramid(const ReferenceInput& input, uint32_t first_layered,
                                   unsigned threads, SapGrid grid) {
  SapPyramid<Real> pyramid{.side_x = Real(std::abs(input.rays.scale_x)),
                           .side_y = Real(std::abs(input.rays.scale_y)),
                           .perspective = input.rays.perspective,
                           .grid = grid};
  const Surface surface =
      build_surface(input.width, input.height, input.rays, input.depth, input.profile, threads);
  SapLevel<Real> level{.width = static_cast<int>(input.width),
                       .height = static_cast<int>(input.height)};
  level.layers[0].resize(surface.patches.size());
  parallel_for(level.layers[0].size(), 4096, threads, [&](size_t i) {
    if (surface.patches[i].area > 0 && input.profile[i] < input.d_m.size()) {
      level.layers[0][i] = first_texel<Real>(input, surface.patches[i], i);
      level.layers[0][i].at_edge = is_at_edge(input, surface, i);
    }
  });
  pyramid.levels.push_back(std::move(level));
  while (pyramid.levels.size() < sap_level_count) {
    const SapLevel<Real>& fine = pyramid.levels.back();
    const bool halves_x = grid.halves(0, pyramid.levels.size()),
               halves_y = grid.halves(1, pyramid.levels.size());
    const Real spacing_x = (halves_x ? 2 : 1) * fine.spacing_x,
               spacing_y = (halves_y ? 2 : 1) * fine.spacing_y;
    SapLevel<Real> coarse{.width = halves_x ? (fine.width + 1) / 2 : fine.width,
                          .height = halves_y ? (fine.height + 1) / 2 : fine.height,
                          .border = 1,
                          .spacing = std::sqrt(spacing_x * spacing_y),
                          .spacing_x = spacing_x,
                          .spacing_y = spacing_y};
    const size_t layers = pyramid.levels.size() < first_layered ? 1 : 2;
    const bool mass_by_area =
        pyramid.levels.size() > first_layered && fine.spacing >= Real(sap_first_area_spacing);
    for (size_t layer = 0; layer < layers; ++layer)
      coarse.layers[layer].resize(coarse.index(coarse.width, coarse.height) + 1);
    parallel_for(static_cast<size_t>(coarse.height + 2), 4, threads, [&](size_t row) {
      const int y = static_cast<int>(row) - 1;
      for (int x = -1; x <= coarse.width; ++x) {
        Children<Real> children{.spacing = fine.spacing,
                                .spacing_x = fine.spacing_x,
                                .spacing_y = fine.spacing_y,
                                .halves_x = halves_x,
                                .halves_y = halves_y};
        bool splits = fine.spacing > 1; // The parent may have two layers.
        for (size_t k = 0; k < no_child; ++k) {
          const std::vector<SapTexel<Real>>& texels = fine.layers[k / children_a_layer];
          if (texels.empty()) continue;
          const int place = static_cast<int>(k % children_a_layer);
          const int cx = (halves_x ? 2 : 1) * x - 1 + place % 4,
                    cy = (halves_y ? 2 : 1) * y - 1 + place / 4;
          if (cx < -fine.border || cy < -fine.border || cx >= fine.width + fine.border ||
              cy >= fine.height + fine.border)
            continue;
          const SapTexel<Real>& child = texels[fine.index(cx, cy)];
          if (child.id == 0) continue;
          children.texels[k] = &child;
          children.left[k] = 1;
          splits = splits || child.at_edge;
        }
        std::array<SapTexel<Real>, 2> planes{};
        for (size_t layer = 0; layer < (splits ? layers : 1); ++layer)
          coarse.layers[layer][coarse.index(x, y)] =
              reduce(pyramid, children, mass_by_area, planes[layer]);
        const std::array<uint8_t, 2> ids = {planes[0].id, planes[1].id};
        for (size_t layer = 0; layer < layers; ++layer) {
          SapTexel<Real>& parent = coarse.layers[layer][coarse.index(x, y)];
          if (parent.id == 0) continue;
          const PerChannel& d = input.d_m[parent.id];
          set_held(pyramid, children, ids, Real(*std::max_element(d.begin(), d.end())),
                   planes[layer], parent);
        }
      }
    });
    pyramid.levels.push_back(std::move(coarse));
  }
  return pyramid;
}
template SapPyramid<float> build_sap_pyramid<float>(const ReferenceInput&, uint32_t, unsigned,
                                                    SapGrid);
template SapPyramid<double> build_sap_pyramid<double>(const ReferenceInput&, uint32_t, unsigned,
                                                      SapGrid);

} // namespace dermis::subsurface
