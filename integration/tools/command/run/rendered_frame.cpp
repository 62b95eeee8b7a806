#include "integration/tools/command/run/rendered_frame.hpp"

#include "integration/tools/command/run/captured.hpp"

#include <algorithm>

namespace dermis::tools {

Image to_image(const demo::FloatImage& image) {
  return {image.width, image.height, image.channels, image.texels};
}

demo::Result<> read_profiles(std::span<const demo::ScatteringProfile> profiles,
                             std::vector<CaptureProfile>& read) {
  Diagnostics diagnostics;
  for (const demo::ScatteringProfile& one : profiles) {
    const auto document = read_document(one.file, diagnostics);
    const auto profile = document ? subsurface::read_profile(*document, diagnostics) : std::nullopt;
    if (profile) read.push_back({one.id, *profile});
  }
  if (!diagnostics.has_errors()) return demo::success();
  std::string text;
  for (const Diagnostic& one : diagnostics.list)
    text += format_for_people(diagnostics, one) + '\n';
  return demo::Error{demo::ErrorKind::input, text};
}

demo::Result<CapturedFrame> captured_frame(const demo::FrameOutputs& frame,
                                           std::span<const CaptureProfile> profiles) {
  CapturedFrame captured;
  FrameDescription& description = captured.description;
  description.width = frame.inputs.lighting.width;
  description.height = frame.inputs.lighting.height;
  description.render = {0, 0, description.width, description.height};
  description.perspective = !frame.camera.orthographic;
  const auto copy = [](const std::array<float, 16>& from, subsurface::Matrix4& to) {
    std::copy(from.begin(), from.end(), to.begin());
  };
  copy(frame.camera.clip_from_view, description.clip_from_view);
  copy(frame.camera.view_from_world, description.view_from_world);
  copy(frame.camera.previous_clip_from_view, description.previous_clip_from_view);
  copy(frame.camera.previous_view_from_world, description.previous_view_from_world);
  description.jitter_px = {static_cast<double>(frame.camera.jitter_pixels[0]),
                           static_cast<double>(frame.camera.jitter_pixels[1])};
  description.clip_from_view = without_jitter(description.clip_from_view, description);
  description.metres_per_unit = static_cast<double>(frame.camera.metres_per_unit);
  description.frame_index = frame.frame;
  description.cut = frame.cut;
  description.exposure = static_cast<double>(frame.exposure);
  description.profiles.assign(profiles.begin(), profiles.end());
  if (!complete_projection(description, captured.rays))
    return demo::Error{demo::ErrorKind::internal, "the camera's projection is not axis-aligned"};

  captured.lighting = to_image(frame.inputs.lighting);
  captured.depth = to_image(frame.inputs.depth);
  captured.normal = to_image(frame.inputs.normal);
  captured.albedo = to_image(frame.inputs.albedo);
  captured.velocity = to_image(frame.inputs.velocity);
  captured.specular = to_image(frame.inputs.specular);
  captured.thickness = to_image(frame.inputs.thickness);
  captured.back_lighting = to_image(frame.inputs.back_lighting);
  captured.profile.reserve(frame.inputs.profile.texels.size());
  for (const float id : frame.inputs.profile.texels)
    captured.profile.push_back(static_cast<uint8_t>(id));
  return captured;
}

} // namespace dermis::tools
