#include "passes/common/reference/reference.hpp"

#include "passes/common/reference/parallel.hpp"
#include "passes/common/reference/planar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace dermis::subsurface {

namespace {

struct PixelRange {
  int64_t x0, x1, y0, y1; // inclusive
};

// Returns the pixels that can show a point within `radius` of `point`: the box around the sphere,
// projected.
PixelRange pixels_within(const ReferenceInput& input, const Vector3& point, double radius) {
  const PixelRays& rays = input.rays;
  const PixelRange all{0, int64_t{input.width} - 1, 0, int64_t{input.height} - 1};
  const double nearest = -point[2] - radius, farthest = -point[2] + radius;
  if (rays.perspective && nearest <= 0) return all;
  auto range = [&](double centre, double scale, double offset, int64_t last) {
    double low = 1e30, high = -1e30;
    for (const double side : {centre - radius, centre + radius})
      for (const double depth : {nearest, farthest}) {
        const double at = ((rays.perspective ? side / depth : side) - offset) / scale;
        low = std::min(low, at);
        high = std::max(high, at);
      }
    return std::pair{static_cast<int64_t>(std::clamp(std::floor(low), 0.0, double(last))),
                     static_cast<int64_t>(std::clamp(std::ceil(high), 0.0, double(last)))};
  };
  const auto [x0, x1] = range(point[0], rays.scale_x, rays.offset_x, all.x1);
  const auto [y0, y1] = range(point[1], rays.scale_y, rays.offset_y, all.y1);
  return {x0, x1, y0, y1};
}

// Accumulates the light that reaches one point, and the total weight.
class Gathered {
public:
  explicit Gathered(const ProfileShape& shape) : shape_(shape) {}

  void add(const PerChannel& weight, const float* light) {
    for (size_t c = 0; c < 3; ++c) {
      light_[c] += weight[c] * light[c];
      total_[c] += weight[c];
    }
  }

  // Adds a patch that is far enough away to be represented by its centre. Weights are computed in
  // batches.
  void add_far(double distance, double area, const float* light) {
    distances_[waiting_] = distance;
    areas_[waiting_] = area;
    lights_[waiting_] = light;
    if (++waiting_ == distances_.size()) weigh();
  }

  // Returns the light that replaces the point's own light.
  PerChannel scattered(const PerChannel& own) {
    weigh();
    PerChannel result = own;
    for (size_t c = 0; c < 3; ++c)
      if (shape_[c].d > 0 && total_[c] > 0)
        result[c] += (1 - shape_[c].direct) * (light_[c] / total_[c] - own[c]);
    return result;
  }

private:
  void weigh() {
    for (size_t c = 0; c < 3; ++c) {
      shape_R(shape_[c], std::span(distances_).first(waiting_), values_);
      for (size_t i = 0; i < waiting_; ++i) {
        const double weight = values_[i] * areas_[i];
        light_[c] += weight * lights_[i][c];
        total_[c] += weight;
      }
    }
    waiting_ = 0;
  }

  const ProfileShape& shape_;
  PerChannel light_{}, total_{};
  size_t waiting_ = 0;
  std::array<double, 256> distances_, areas_, values_;
  std::array<const float*, 256> lights_;
};

PerChannel scatter_at(const ReferenceInput& input, const Surface& surface, uint32_t pixel) {
  const float* light = &input.light[size_t{3} * pixel];
  const PerChannel own = {light[0], light[1], light[2]};
  const uint8_t id = input.profile[pixel];
  const Patch& here = surface.patches[pixel];
  if (id == 0 || id >= input.d_m.size() || here.area == 0) return own;
  ProfileShape shape = input.shape_of(id);
  const double scale =
      input.scatter_scale.empty() ? 1.0 : std::max(0.0f, input.scatter_scale[pixel]);
  for (ChannelShape& channel : shape)
    channel = scaled(channel, scale);
  if (!(std::max({shape[0].d, shape[1].d, shape[2].d}) > 0)) return own;

  // A pixel's nearest part is at most half a patch's diagonal nearer than its centre.
  const double radius = reach_of(shape) + half_pixel_diagonal(input.rays, -here.position[2]);
  const PixelRange range = pixels_within(input, here.position, radius);
  const int64_t px = pixel % input.width, py = pixel / input.width;
  Gathered gathered(shape);
  for (int64_t y = range.y0; y <= range.y1; ++y)
    for (int64_t x = range.x0; x <= range.x1; ++x) {
      const auto q = static_cast<size_t>(y * input.width + x);
      const Patch& patch = surface.patches[q];
      if (input.profile[q] != id || patch.area == 0) continue;
      const float* from = &input.light[3 * q];
      if (x == px && y == py) {
        gathered.add(centre_integral(input.rays, patch, double(x), double(y), shape), from);
        continue;
      }
      const Vector3 offset = patch.position - here.position;
      const double squared = dot(offset, offset);
      if (squared > radius * radius) continue;
      if (std::max(std::abs(x - px), std::abs(y - py)) > near_pixels) {
        gathered.add_far(std::sqrt(squared), patch.area, from);
        continue;
      }
      PerChannel weight =
          patch_mean(input.rays, patch, double(x), double(y), true, here.position, shape);
      for (double& w : weight)
        w *= patch.area;
      gathered.add(weight, from);
    }
  return gathered.scattered(own);
}

// O'Neill 2014, pcg32.
struct Pcg32 {
  uint64_t state;

  uint32_t next() {
    const uint64_t old = state;
    state = old * 6364136223846793005u + 1442695040888963407u;
    const auto shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<uint32_t>(old >> 59);
    return (shifted >> turn) | (shifted << ((32 - turn) & 31));
  }
};

} // namespace

std::vector<double> reference_at(const ReferenceInput& input, std::span<const uint32_t> pixels,
                                 ReferenceOptions options) {
  const Surface surface = build_surface(input.width, input.height, input.rays, input.depth,
                                        input.profile, options.threads);
  std::vector<double> result(3 * pixels.size());
  parallel_for(pixels.size(), 16, options.threads, [&](size_t i) {
    const PerChannel value = scatter_at(input, surface, pixels[i]);
    std::copy(value.begin(), value.end(), result.begin() + static_cast<std::ptrdiff_t>(3 * i));
  });
  return result;
}

std::vector<double> reference_everywhere(const ReferenceInput& input, ReferenceOptions options) {
  if (options.planar_shortcut && is_planar(input)) return planar_reference(input, options.threads);
  std::vector<uint32_t> pixels(size_t{input.width} * input.height);
  std::iota(pixels.begin(), pixels.end(), 0u);
  return reference_at(input, pixels, options);
}

std::vector<uint32_t> stratified_subset(uint32_t width, uint32_t height,
                                        std::span<const uint8_t> profile, uint32_t count,
                                        uint64_t seed) {
  constexpr uint32_t tile = 8;
  std::vector<uint32_t> candidates;
  for (uint32_t ty = 0; ty < height; ty += tile)
    for (uint32_t tx = 0; tx < width; tx += tile)
      for (uint32_t y = ty; y < std::min(height, ty + tile); ++y)
        for (uint32_t x = tx; x < std::min(width, tx + tile); ++x)
          if (profile[size_t{y} * width + x] != 0) candidates.push_back(y * width + x);
  if (candidates.size() > count) {
    Pcg32 random{seed * 0x9e3779b97f4a7c15u + 1};
    random.next();
    std::vector<uint32_t> chosen(count);
    for (uint64_t k = 0; k < count; ++k) {
      const uint64_t first = k * candidates.size() / count,
                     last = (k + 1) * candidates.size() / count;
      chosen[k] = candidates[first + random.next() % (last - first)];
    }
    candidates = std::move(chosen);
  }
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

} // namespace dermis::subsurface
