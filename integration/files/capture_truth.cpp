#include "integration/files/capture_truth.hpp"

namespace dermis::tools {

namespace {

constexpr double metres_per_mm = 1e-3;

// The rectangle's values out of a picture's.
template <class T>
std::vector<T> crop(const std::vector<T>& values, uint32_t width, const Rectangle& part, uint32_t channels) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(size_t{part.width} * part.height * channels);
  for (uint32_t y = part.y; y < part.y + part.height; ++y) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>((size_t{y} * width + part.x) * channels);
    result.insert(result.end(), first, first + static_cast<std::ptrdiff_t>(size_t{part.width} * channels));
  }
  return result;
}

} // namespace

subsurface::TruthInput TruthFrame::input() const {
  return {width, height, rays, light, depth, profile, scatter_scale, d_m, shapes};
}

TruthFrame make_truth_frame(const CapturedFrame& frame) {
  const FrameDescription& description = frame.description;
  const Rectangle& part = description.render;
  TruthFrame result{.width = part.width,
                    .height = part.height,
                    .rays = frame.rays,
                    .light = crop(frame.lighting.values, description.width, part, 3),
                    .depth = crop(frame.depth.values, description.width, part, 1),
                    .scatter_scale = crop(frame.scatter_scale.values, description.width, part, 1),
                    .profile = crop(frame.profile, description.width, part, 1),
                    .d_m = std::vector<subsurface::PerChannel>(256),
                    .shapes = std::vector<subsurface::ProfileShape>(256)};
  for (const CaptureProfile& known : description.profiles)
    for (size_t c = 0; c < 3; ++c) {
      result.d_m[known.id][c] = known.profile.d_mm[c] * metres_per_mm;
      result.shapes[known.id][c] = subsurface::scaled(known.profile.shape_mm[c], metres_per_mm);
    }
  return result;
}

} // namespace dermis::tools
