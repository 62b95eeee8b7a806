// Converts a surface of the family to a frame.

#include "integration/tools/command/bench/family/catalogue.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr uint32_t light_samples = 4;    // per side of a pixel, of the light
constexpr double slope_reach = 0.25;     // mean pixel sides, of the differences that give a slope
constexpr double flat_view_distance = 1; // of an orthographic view, unless the surface is higher
constexpr double perspective_distance = 1.5; // picture heights
constexpr double second_d = 3;               // d of the second material / d of the first

subsurface::Profile wide_profile() {
  subsurface::Profile wide = grey_profile();
  wide.name = "wide grey";
  wide.source = "one d of 3 mm in every channel";
  for (double& dmfp : wide.dmfp_mm)
    dmfp *= second_d;
  subsurface::derive(wide);
  return wide;
}

double pattern_at(const FamilyScene& scene, const FamilyLayer& layer, Place p, Place size) {
  const double h = slope_reach;
  const uint64_t seed = scene.member.seed;
  switch (scene.pattern) {
  case FamilyPattern::shade:
    return shade((layer.rise({p.x + h, p.y}) - layer.rise({p.x - h, p.y})) / (2 * h),
                 (layer.rise({p.x, p.y + h}) - layer.rise({p.x, p.y - h})) / (2 * h));
  case FamilyPattern::texture:
    return texture({p.x + 1040 + 160 * double(seed % 97), p.y + 1040 + 160 * double(seed % 89)});
  case FamilyPattern::edge:
    return p.x < 0.5 * size.x - 0.5 ? 1 : 0.15;
  case FamilyPattern::bands:
    return bands(p.x + double(seed % 16), 16);
  case FamilyPattern::waves:
    return 0.5 + 0.4 * std::sin(p.x / 8 + double(seed)) * std::sin(p.y / 11);
  }
  return 0;
}

double light_at(const FamilyScene& scene, const FamilyLayer& layer, Place p, Place size) {
  if (layer.light) return layer.light(p);
  return pattern_at(scene, layer, p, size) * (layer.gain ? layer.gain(p) : 1);
}

// Sides of a pixel in mean sides.
struct Sides {
  double x = 1, y = 1;
};

double mean_light(const FamilyScene& scene, const FamilyLayer& layer, Place centre, Place size,
                  Sides sides) {
  double sum = 0;
  for (uint32_t j = 0; j < light_samples; ++j)
    for (uint32_t i = 0; i < light_samples; ++i)
      sum += light_at(scene, layer,
                      {centre.x + ((i + 0.5) / light_samples - 0.5) * sides.x,
                       centre.y + ((j + 0.5) / light_samples - 0.5) * sides.y},
                      size);
  return sum / (light_samples * light_samples);
}

// Sets the projection: pixels have the given sides in metres at `distance`.
void set_view(CapturedFrame& frame, double side_x, double side_y, double distance,
              bool perspective) {
  FrameDescription& description = frame.description;
  const double half_width = 0.5 * description.width * side_x,
               half_height = 0.5 * description.height * side_y;
  description.perspective = perspective;
  if (!perspective && side_x == side_y) {
    description.pixel_pitch_m = side_x;
  } else if (perspective) {
    description.clip_from_view = {
        distance / half_width, 0, 0, 0,  0, -distance / half_height, 0, 0, 0, 0, 0,
        0.01 * distance,       0, 0, -1, 0};
  } else {
    description.clip_from_view = {
        1 / half_width, 0, 0, 0, 0, -1 / half_height, 0, 0, 0, 0, -0.01 / distance, 0, 0, 0, 0, 1};
  }
  if (!complete_projection(description, frame.rays)) description.width = 0; // cannot happen
  description.previous_clip_from_view = description.clip_from_view;
}

} // namespace

CapturedFrame generate_family_scene(const FamilyScene& scene, uint32_t width, uint32_t height,
                                    const subsurface::Profile& skin) {
  const Sides sides{std::sqrt(scene.aspect), 1 / std::sqrt(scene.aspect)};
  const Place size{width * sides.x, height * sides.y};
  const FamilySurface surface =
      scene.kind->make({scene.values, static_cast<uint32_t>(scene.member.seed), scene.d_px, size});
  std::vector<CaptureProfile> profiles{{1, scene.skin ? skin : grey_profile()}};
  if (surface.material) profiles.push_back({2, wide_profile()});
  CapturedFrame frame = plane_frame(width, height, scene.d_px, profiles);
  const double pitch = *frame.description.pixel_pitch_m;
  frame.description.pixel_pitch_m.reset();

  double highest = 0;
  std::vector<double> rises(size_t{width} * height);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const Place place{x * sides.x, y * sides.y};
      const int visible = surface.visible ? surface.visible({x, y}, place) : 0;
      const size_t at = size_t{y} * width + x;
      const bool there = visible != FamilySurface::background;
      const FamilyLayer& layer = surface.layers[there ? static_cast<size_t>(visible) : 0];
      rises[at] = there ? layer.rise(place) : 0;
      highest = std::max(highest, rises[at]);
      frame.profile[at] =
          there ? (surface.material ? surface.material({x, y}, place) : uint8_t{1}) : uint8_t{0};
      const double light = there ? mean_light(scene, layer, place, size, sides) : 0;
      for (uint32_t c = 0; c < 3; ++c)
        frame.lighting.at(x, y, c) = static_cast<float>(light);
    }
  const double distance =
      scene.perspective ? std::max(perspective_distance * height * sides.y, 2 * highest) * pitch
                        : std::max(flat_view_distance, 2 * highest * pitch);
  for (size_t i = 0; i < rises.size(); ++i)
    frame.depth.values[i] =
        frame.profile[i] != 0 ? static_cast<float>(distance - rises[i] * pitch) : 0.0f;
  set_view(frame, sides.x * pitch, sides.y * pitch, distance, scene.perspective);
  return frame;
}

} // namespace dermis::tools
