#include "integration/tools/files/bytes.hpp"
#include "integration/tools/files/capture.hpp"
#include "integration/tools/files/capture_pictures.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <system_error>

namespace dermis::tools {

namespace fs = std::filesystem;

namespace {

// Formats a matrix in four lines, as docs/capture.md shows.
std::string matrix_text(const subsurface::Matrix4& m) {
  std::string text = "[";
  for (size_t row = 0; row < 4; ++row)
    text += fmt::format("{}{}, {}, {}, {}", row == 0 ? "" : ",\n    ", m[4 * row], m[4 * row + 1],
                        m[4 * row + 2], m[4 * row + 3]);
  return text + "]";
}

bool is_file_of_frame(const fs::path& file) {
  if (file.filename() == "frame.json") return true;
  const std::string name = file.stem().string();
  return file.extension() == ".exr" &&
         (name == "profile" || std::ranges::any_of(picture_kinds(), [&](const PictureKind& kind) {
            return name == kind.name;
          }));
}

// Returns a path in the folder that is no part of a frame, or "".
fs::path foreign_in_frame(const fs::path& folder) {
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code))
    if (!entry.is_regular_file(code) || !is_file_of_frame(entry.path())) return entry.path();
  return {};
}

// Returns a path in the folder that is no part of a capture and would be lost, or "".
fs::path foreign_in_capture(const fs::path& folder) {
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    const fs::path& path = entry.path();
    const bool frame = entry.is_directory(code) && fs::exists(path / "frame.json", code);
    const fs::path foreign = frame ? foreign_in_frame(path)
                             : entry.is_regular_file(code) && is_file_of_frame(path) ? fs::path()
                                                                                     : path;
    if (!foreign.empty()) return foreign;
  }
  return {};
}

// Returns why the folder cannot be replaced by a capture, or "".
std::string why_kept(const fs::path& folder) {
  std::error_code code;
  if (!fs::exists(folder, code)) return "";
  if (!fs::is_directory(folder, code))
    return fmt::format("'{}' exists and is not a folder", folder.string());
  const fs::path foreign = foreign_in_capture(folder);
  return foreign.empty()
             ? ""
             : fmt::format("'{}' holds '{}', which is not part of a capture and would be deleted; "
                           "choose another folder",
                           folder.string(), foreign.lexically_relative(folder).string());
}

} // namespace

std::string describe_frame(const FrameDescription& f) {
  std::string text = "{\n";
  text += fmt::format("  \"dermis_capture\": {},\n  \"width\": {}, \"height\": {},\n",
                      capture_format_version, f.width, f.height);
  text += fmt::format("  \"render_rectangle\": [{}, {}, {}, {}],\n", f.render.x, f.render.y,
                      f.render.width, f.render.height);
  text +=
      fmt::format("  \"projection\": \"{}\",\n", f.perspective ? "perspective" : "orthographic");
  if (f.pixel_pitch_m)
    text += fmt::format("  \"pixel_pitch_m\": {},\n", *f.pixel_pitch_m);
  else
    text += fmt::format("  \"clip_from_view\": {},\n  \"previous_clip_from_view\": {},\n  "
                        "\"metres_per_unit\": {},\n",
                        matrix_text(f.clip_from_view), matrix_text(f.previous_clip_from_view),
                        f.metres_per_unit);
  text += fmt::format("  \"view_from_world\": {},\n  \"previous_view_from_world\": {},\n",
                      matrix_text(f.view_from_world), matrix_text(f.previous_view_from_world));
  text += fmt::format(
      "  \"jitter_px\": [{}, {}],\n  \"frame_index\": {},\n  \"cut\": {},\n  \"exposure\": {},\n  "
      "\"profiles\": [",
      f.jitter_px[0], f.jitter_px[1], f.frame_index, f.cut, f.exposure);
  for (size_t i = 0; i < f.profiles.size(); ++i) {
    text += fmt::format("{}\n    {{ \"id\": {}, {} }}", i == 0 ? "" : ",", f.profiles[i].id,
                        subsurface::profile_members(f.profiles[i].profile));
  }
  return text + "\n  ]\n}\n";
}

bool CaptureWriter::begin(const fs::path& folder, std::string& error) {
  std::error_code code;
  target_ = fs::absolute(folder, code).lexically_normal();
  if (!target_.has_filename()) target_ = target_.parent_path(); // path ended with a slash
  error = why_kept(target_);
  if (!error.empty()) return false;
  part_ = temporary_path(target_);
  frames_ = 0;
  fs::create_directories(part_, code);
  if (code) error = fmt::format("'{}' cannot be made: {}", folder.string(), code.message());
  return !code;
}

bool CaptureWriter::add(const CapturedFrame& frame, std::string& error) {
  const fs::path folder = part_ / fmt::format("frame_{:04}", frames_);
  std::error_code code;
  if (!fs::create_directory(folder, code)) {
    error = fmt::format("'{}' cannot be made: {}", folder.string(), code.message());
    return false;
  }
  Image ids = Image::sized(frame.description.width, frame.description.height, 1);
  if (frame.profile.size() != ids.values.size()) {
    error = fmt::format("{} profile ids for {} x {} pixels", frame.profile.size(), ids.width,
                        ids.height);
    return false;
  }
  ids.values.assign(frame.profile.begin(), frame.profile.end());
  if (!write_exr(folder / "profile.exr", ids, profile_channels()[0], error)) return false;
  for (const PictureKind& kind : picture_kinds()) {
    const Image& image = frame.*kind.image;
    if (image.values.empty() && !kind.required) continue;
    if (image.width != ids.width || image.height != ids.height) {
      error = fmt::format("'{}' is {} x {} in a frame of {} x {}", kind.name, image.width,
                          image.height, ids.width, ids.height);
      return false;
    }
    if (!write_exr(folder / (std::string(kind.name) + ".exr"), image, kind.channels[0], error))
      return false;
  }
  ++frames_;
  return write_text(folder / "frame.json", describe_frame(frame.description), error);
}

bool CaptureWriter::finish(std::string& error) {
  error = why_kept(target_); // files may have come since begin()
  if (!error.empty()) return false;
  std::error_code code;
  if (fs::exists(target_, code)) {
    // Folders cannot be exchanged in one step. The old folder is renamed first, so that a complete
    // capture always exists.
    const fs::path old = temporary_path(target_);
    fs::rename(target_, old, code);
    if (!code) fs::rename(part_, target_, code);
    std::error_code ignored;
    if (code && fs::exists(old, ignored)) fs::rename(old, target_, ignored);
    if (!code) fs::remove_all(old, ignored);
  } else {
    fs::rename(part_, target_, code);
  }
  if (code) {
    error = fmt::format("'{}' cannot be put in place: {}", target_.string(), code.message());
    return false;
  }
  part_.clear();
  return true;
}

CaptureWriter::~CaptureWriter() {
  std::error_code ignored;
  if (!part_.empty()) fs::remove_all(part_, ignored);
}

} // namespace dermis::tools
