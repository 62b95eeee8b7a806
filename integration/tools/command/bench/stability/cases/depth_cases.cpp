// Invalid depths, and depth buffers of all kinds of projections.
#include "integration/tools/command/bench/stability/cases.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

// The right half has an invalid depth. The left half must be unaffected.
StabilityCase odd_depth(std::string_view name, float depth) {
  const auto with = [depth](bool damaged) {
    return [depth, damaged](uint32_t) {
      CapturedFrame frame = sound_frame();
      for_pixels(frame, [&](uint32_t x, uint32_t y, size_t i) {
        if (!is_right_half(x)) return;
        frame.depth.at(x, y, 0) = damaged ? depth : 0.0f;
        frame.profile[i] = damaged ? 1 : 0;
      });
      return frame;
    };
  };
  return {.name = name, .given = with(true), .same_as = with(false), .bound = furnace};
}

std::function<CapturedFrame(uint32_t)> at_depth(float metres) {
  return [metres](uint32_t) {
    CapturedFrame frame = sound_frame();
    std::fill(frame.depth.values.begin(), frame.depth.values.end(), metres);
    return frame;
  };
}

StabilityCase far_plane(std::string_view name, float metres) {
  return {.name = name, .given = at_depth(metres), .expected = white, .bound = furnace};
}

enum class View : uint8_t { perspective, orthographic };
enum class Range : uint8_t { forward, reversed };
constexpr double near_m = 0.1, far_m = 100, no_far_m = infinity;

// Returns a projection with only the entries that matter for depth: device = (f * z + g) / w at
// view z, w = -z or 1.
subsurface::Matrix4 projection(View view, Range range, double far_plane, double slope) {
  subsurface::Matrix4 m{};
  m[0] = 1 / slope;
  m[5] = -1 / slope;
  double f = 0, g = 0;
  if (view == View::perspective) {
    const bool ends = far_plane < no_far_m;
    f = ends ? -far_plane / (far_plane - near_m) : -1;
    g = ends ? -far_plane * near_m / (far_plane - near_m) : -near_m;
    m[14] = -1;
    if (range == Range::reversed) f = -1 - f, g = -g; // 1 - device
  } else {
    f = -1 / (far_plane - near_m);
    g = -near_m / (far_plane - near_m);
    m[15] = 1;
    if (range == Range::reversed) f = -f, g = 1 - g;
  }
  m[10] = f;
  m[11] = g;
  return m;
}

// Replaces the orthographic camera without a projection by one that sees as much at 1 m.
void set_camera(CapturedFrame& frame, View view, Range range, double far_plane) {
  FrameDescription& description = frame.description;
  const double pitch = *description.pixel_pitch_m;
  description.pixel_pitch_m.reset();
  description.perspective = view == View::perspective;
  description.clip_from_view = projection(view, range, far_plane, pitch * stability_side / 2);
  complete_projection(description, frame.rays);
  description.previous_clip_from_view = description.clip_from_view;
}

// One pixel has an invalid depth, under a perspective camera: all others must be unaffected.
StabilityCase one_odd_depth(std::string_view name, float depth) {
  const auto with = [](float of_pixel) {
    return [of_pixel](uint32_t) {
      CapturedFrame frame = textured_frame();
      set_camera(frame, View::perspective, Range::forward, far_m);
      std::fill(frame.depth.values.begin(), frame.depth.values.end(), 1.0f);
      frame.depth.at(stability_side / 2, stability_side / 2, 0) = of_pixel;
      return frame;
    };
  };
  return {.name = name, .given = with(depth), .same_as = with(0), .bound = furnace};
}

// A tilted plane at 1 m with sky on the right. The depth buffer must give the same result as
// distances.
StabilityCase depth_buffer(std::string_view name, View view, Range range, double far_plane) {
  const auto make = [=](uint32_t) {
    CapturedFrame frame = textured_frame();
    const double pitch = *frame.description.pixel_pitch_m;
    set_camera(frame, view, range, far_plane);
    for_pixels(frame, [&](uint32_t x, uint32_t y, size_t i) {
      const bool sky = x >= 36;
      frame.depth.at(x, y, 0) = sky ? 0.0f : static_cast<float>(1 + pitch * x);
      if (sky) frame.profile[i] = 0;
    });
    return frame;
  };
  return {.name = name,
          .given = make,
          .same_as = make,
          .metric = Metric::light_rms,
          .bound = furnace, // a float step is 1 micrometre there, a thousandth of d
          .depth = DepthGiven::depth_buffer};
}

} // namespace

std::vector<StabilityCase> depth_cases() {
  return {odd_depth("depth_zero_beside", 0),
          odd_depth("depth_nan_beside", not_a_number),
          odd_depth("depth_infinity_beside", infinity),
          odd_depth("depth_negative_beside", -1),
          one_odd_depth("depth_denormal_alone", 1e-44f),
          far_plane("depth_1e-6_m", 1e-6f),
          far_plane("depth_1e6_m", 1e6f),
          {.name = "nothing_but_sky", .given = at_depth(0), .finite_only = true},
          depth_buffer("depth_forward", View::perspective, Range::forward, far_m),
          depth_buffer("depth_reversed", View::perspective, Range::reversed, far_m),
          depth_buffer("depth_forward_infinite_far", View::perspective, Range::forward, no_far_m),
          depth_buffer("depth_reversed_infinite_far", View::perspective, Range::reversed, no_far_m),
          depth_buffer("depth_orthographic", View::orthographic, Range::forward, far_m),
          depth_buffer("depth_orthographic_reversed", View::orthographic, Range::reversed, far_m)};
}

} // namespace dermis::tools
