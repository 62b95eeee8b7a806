#include "integration/tools/files/capture_reference.hpp"

#include <algorithm>

namespace dermis::tools {

namespace {

constexpr double metres_per_mm = 1e-3;
// Minimum thickness of a slab, metres. Without scattering even this transmits no light.
constexpr double thinnest_m = 1e-9;

// Returns the values inside the rectangle.
template <class T>
std::vector<T> crop(const std::vector<T>& values, uint32_t width, const Rectangle& part,
                    uint32_t channels) {
  std::vector<T> result;
  if (values.empty()) return result;
  result.reserve(size_t{part.width} * part.height * channels);
  for (uint32_t y = part.y; y < part.y + part.height; ++y) {
    const auto first =
        values.begin() + static_cast<std::ptrdiff_t>((size_t{y} * width + part.x) * channels);
    result.insert(result.end(), first,
                  first + static_cast<std::ptrdiff_t>(size_t{part.width} * channels));
  }
  return result;
}

} // namespace

subsurface::ReferenceInput ReferenceFrame::input() const {
  return {width, height, rays, light, depth, profile, scatter_scale, d_m, shapes};
}

ReferenceFrame make_reference_frame(const CapturedFrame& frame) {
  const FrameDescription& description = frame.description;
  const Rectangle& part = description.render;
  ReferenceFrame result{.width = part.width,
                        .height = part.height,
                        .rays = frame.rays,
                        .light = crop(frame.lighting.values, description.width, part, 3),
                        .depth = crop(frame.depth.values, description.width, part, 1),
                        .scatter_scale =
                            crop(frame.scatter_scale.values, description.width, part, 1),
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

void add_transmission(const CapturedFrame& frame, ReferenceFrame& reference) {
  const Rectangle& part = frame.description.render;
  const std::vector<float> thickness =
      crop(frame.thickness.values, frame.description.width, part, 1);
  const std::vector<float> behind =
      crop(frame.back_lighting.values, frame.description.width, part, 3);
  if (thickness.empty() || behind.empty()) return;
  for (size_t i = 0; i < thickness.size(); ++i) {
    if (reference.profile[i] == 0) continue;
    const double scale =
        reference.scatter_scale.empty() ? 1.0 : static_cast<double>(reference.scatter_scale[i]);
    const double metres = std::max(static_cast<double>(thickness[i]), thinnest_m);
    for (size_t c = 0; c < 3; ++c) {
      const subsurface::ChannelShape shape =
          subsurface::scaled(reference.shapes[reference.profile[i]][c], scale);
      const double through = (1 - shape.direct) * subsurface::shape_survival(shape, metres);
      reference.light[3 * i + c] +=
          static_cast<float>(through * static_cast<double>(behind[3 * i + c]));
    }
  }
}

} // namespace dermis::tools
