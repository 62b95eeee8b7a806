#include "integration/tools/command/run/captured.hpp"

#include "framegraph/text/json_writer.hpp"
#include "integration/tools/command/output_kind.hpp"
#include "integration/tools/command/shipped.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>

namespace dermis::tools {
namespace {

// Shifts the image by `sign` times the frame's jitter: clip x and y, in units of half the
// rectangle, times w.
subsurface::Matrix4 shifted(const subsurface::Matrix4& matrix, const FrameDescription& frame,
                            double sign) {
  subsurface::Matrix4 out = matrix;
  for (size_t column = 0; column < 4; ++column) {
    out[column] += sign * 2.0 * frame.jitter_px[0] / frame.render.width * matrix[12 + column];
    out[4 + column] += sign * 2.0 * frame.jitter_px[1] / frame.render.height * matrix[12 + column];
  }
  return out;
}

void copy(const subsurface::Matrix4& from, float* to) {
  std::transform(from.begin(), from.end(), to,
                 [](double value) { return static_cast<float>(value); });
}

} // namespace

std::filesystem::path profiles_folder(const std::string& option) {
  return option.empty() ? shipped("configs/profiles") : option;
}

std::optional<CapturedSequence> check_sequence(const Session& session, const std::string& folder,
                                               const std::string& profiles,
                                               const std::vector<std::string>& roots) {
  CapturedSequence sequence;
  sequence.profiles = profiles_folder(profiles);
  sequence.roots = roots;
  Diagnostics diagnostics;
  sequence.folders = find_frames(folder, diagnostics, roots);
  for (const std::filesystem::path& one : sequence.folders) {
    const auto frame = read_frame(one, sequence.profiles, diagnostics, roots);
    if (frame) sequence.sanitised_values += frame->sanitised.not_finite + frame->sanitised.negative;
    // A folder that is itself a frame has no frame name.
    sequence.names.push_back(one == std::filesystem::path(folder) ? "frame_0000"
                                                                  : one.filename().string());
  }
  if (diagnostics.has_errors()) {
    fail(session, ExitCode::problems, fmt::format("the capture '{}' cannot be used", folder),
         &diagnostics);
    return std::nullopt;
  }
  print_beside_document(session, diagnostics);
  return sequence;
}

std::optional<CapturedFrame> load_frame(const CapturedSequence& sequence, size_t index) {
  Diagnostics already_reported;
  return read_frame(sequence.folders[index], sequence.profiles, already_reported, sequence.roots);
}

void warn_of_earlier(std::string_view verb, const std::string& folder,
                     const CapturedSequence& sequence,
                     std::initializer_list<std::string_view> images) {
  std::set<std::string> written;
  for (const std::string& name : sequence.names)
    for (const std::string_view image : images)
      written.insert(fmt::format("{}/{}", name, image));
  if (const std::string earlier = earlier_outputs(verb, folder, written); !earlier.empty())
    spdlog::warn("{}", for_terminal(earlier));
}

std::string profile_as_json(const subsurface::Profile& profile) {
  JsonWriter file;
  file.open_object().member("dermis_profile", 1).member("name", profile.name);
  file.member("source", profile.source).close();
  std::string text = std::move(file).finish();
  text.insert(text.rfind('}'), ", " + subsurface::profile_members(profile));
  return text;
}

dermis_frame c_frame(const FrameDescription& frame) {
  dermis_frame out = DERMIS_FRAME_INIT;
  out.rect_x = frame.render.x;
  out.rect_y = frame.render.y;
  out.rect_width = frame.render.width;
  out.rect_height = frame.render.height;
  copy(with_jitter(frame.clip_from_view, frame), out.clip_from_view);
  copy(frame.view_from_world, out.view_from_world);
  copy(frame.previous_clip_from_view, out.previous_clip_from_view);
  copy(frame.previous_view_from_world, out.previous_view_from_world);
  out.jitter_x = static_cast<float>(frame.jitter_px[0]);
  out.jitter_y = static_cast<float>(frame.jitter_px[1]);
  out.metres_per_unit = static_cast<float>(frame.metres_per_unit);
  out.exposure = static_cast<float>(frame.exposure);
  out.flags = frame.cut ? DERMIS_FRAME_RESET_HISTORY : 0;
  out.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
  return out;
}

subsurface::Matrix4 with_jitter(const subsurface::Matrix4& clip_from_view,
                                const FrameDescription& frame) {
  return shifted(clip_from_view, frame, 1.0);
}

subsurface::Matrix4 without_jitter(const subsurface::Matrix4& clip_from_view,
                                   const FrameDescription& frame) {
  return shifted(clip_from_view, frame, -1.0);
}

} // namespace dermis::tools
