// The plane on which generated scenes and property tests are based.

#include "integration/tools/command/bench/subject.hpp"

#include <algorithm>

namespace dermis::tools {

subsurface::Profile grey_profile() {
  subsurface::Profile grey;
  grey.name = "grey";
  grey.dmfp_mm = {3.5, 3.5, 3.5}; // at albedo 0.33, d = dmfp / 3.5 (Christensen & Burley 2015)
  grey.albedo = {0.33, 0.33, 0.33};
  grey.source = "one d of 1 mm in every channel";
  subsurface::derive(grey);
  return grey;
}

CapturedFrame plane_frame(uint32_t width, uint32_t height, double d_px,
                          std::span<const CaptureProfile> profiles) {
  CapturedFrame frame;
  FrameDescription& description = frame.description;
  description.width = width;
  description.height = height;
  description.render = {0, 0, width, height};
  description.perspective = false;
  description.profiles.assign(profiles.begin(), profiles.end());
  const auto& profile = description.profiles.front().profile;
  description.pixel_pitch_m = profile.d_mm[static_cast<size_t>(profile.widest)] * 1e-3 / d_px;
  constexpr subsurface::Matrix4 identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  description.view_from_world = description.previous_view_from_world = identity;
  complete_projection(description, frame.rays);
  description.previous_clip_from_view = description.clip_from_view;

  frame.lighting = Image::sized(width, height, 3);
  frame.depth = Image::sized(width, height, 1);
  frame.albedo = Image::sized(width, height, 3);
  for (Image* image : {&frame.lighting, &frame.depth, &frame.albedo})
    std::fill(image->values.begin(), image->values.end(), 1.0f);
  frame.profile.assign(size_t{width} * height, 1);
  return frame;
}

} // namespace dermis::tools
