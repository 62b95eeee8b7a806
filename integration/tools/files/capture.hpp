#pragma once
// The capture folder: what a frame graph was given, as a frame.json and EXR pictures a frame. docs/capture.md
// is the format's full description. Made by `dermis render --capture`, or by anyone's own engine.

#include "framegraph/text/document.hpp"
#include "integration/tools/files/image.hpp"
#include "passes/common/camera.hpp"
#include "passes/common/profiles/profile.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

inline constexpr int64_t capture_format_version = 1;

struct Rectangle {
  uint32_t x = 0, y = 0, width = 0, height = 0; // pixels
};

struct CaptureProfile {
  uint32_t id = 0; // 1..255, as in the `profile` picture
  subsurface::Profile profile;
};

// The largest half float: graphs take brighter light for this much.
inline constexpr float max_light = 65504;

// What was repaired while reading, in pixels with a profile (others do not matter).
struct SanitisedCounts {
  uint64_t not_finite = 0; // NaN or infinite, now 0
  uint64_t negative = 0;   // negative light, depth, albedo or scatter_scale, now 0
  uint64_t too_bright = 0; // pixels with light above max_light, which is kept; graphs clamp it
  float brightest = 0;     // the largest such value
};

// frame.json.
struct FrameDescription {
  uint32_t width = 0, height = 0; // of the pictures
  Rectangle render;               // the part that was rendered, inside the pictures
  bool perspective = true;
  // Row-major, for column vectors; clip_from_view without jitter. Right-handed: files of a left-handed view
  // space are mirrored when they are read, and so is `normal`.
  subsurface::Matrix4 clip_from_view{}, view_from_world{}, previous_clip_from_view{},
      previous_view_from_world{};
  std::optional<double> pixel_pitch_m; // orthographic captures made by hand: clip_from_view follows from it
  double metres_per_unit = 1;
  std::array<double, 2> jitter_px{};
  uint64_t frame_index = 0;
  double exposure = 1;
  std::vector<CaptureProfile> profiles;
};

// Pictures have width * height pixels; an optional one that is absent has no values.
struct CapturedFrame {
  FrameDescription description;
  subsurface::PixelRays rays;     // of the render rectangle, metres
  Image lighting;                 // 3: diffuse irradiance before albedo, linear
  Image depth;                    // 1: view depth, metres; 0: nothing there
  std::vector<uint8_t> profile;   // id, 0: no subsurface scattering
  Image albedo, normal, specular; // 3, optional
  // 2, optional: now - previous position, pixels, +x right, +y down; not in files a third, view depth, units
  Image velocity;
  Image scatter_scale; // 1, optional: multiplies d
  // Optional, both or none: way of the light from behind through the material, metres (1), and its irradiance
  // on the far side, linear (3).
  Image thickness, back_lighting;
  SanitisedCounts sanitised;
};

// Folders that a capture may read from beside its own and that of the profiles: links of theirs count as what
// they lead to.
using FileRoots = std::span<const std::string>;

// The frames of a capture in order of their names: sub-folders that hold a frame.json, or the folder itself.
// Empty with an error if there is none, or if one is a link out of `folder`. `diagnostics` may be any
// thread's own.
std::vector<std::filesystem::path> find_frames(const std::filesystem::path& folder, Diagnostics& diagnostics,
                                               FileRoots roots = {});

// Reads and checks one frame. A profile's "file" is looked up below the folder of frame.json, or, where it is
// a plain name, as <profile_folder>/<name>.json. Damaged values are repaired, counted and reported as a
// warning. Empty with located errors if anything else is wrong.
std::optional<CapturedFrame> read_frame(const std::filesystem::path& folder,
                                        const std::filesystem::path& profile_folder, Diagnostics& diagnostics,
                                        FileRoots roots = {});

// frame.json alone: the pictures stay empty. `folder` is where the document stands.
std::optional<CapturedFrame> read_description(const Document& document, const std::filesystem::path& folder,
                                              const std::filesystem::path& profile_folder,
                                              Diagnostics& diagnostics, FileRoots roots = {});

// Fills `rays` from the description, and clip_from_view from pixel_pitch_m where that is given. False: no
// projection.
bool complete_projection(FrameDescription& description, subsurface::PixelRays& rays);

// Writes a capture so that it is there whole or not at all: into a folder beside `folder`, which `finish`
// renames. A capture that stood there is replaced; any other non-empty folder is refused. Without finish
// nothing stays.
class CaptureWriter {
public:
  // False with the reason in `error` if the place cannot be used.
  bool begin(const std::filesystem::path& folder, std::string& error);
  bool add(const CapturedFrame& frame, std::string& error); // frame_0000, frame_0001, ...
  bool finish(std::string& error);

  CaptureWriter() = default;
  ~CaptureWriter();
  CaptureWriter(const CaptureWriter&) = delete;
  CaptureWriter& operator=(const CaptureWriter&) = delete;

private:
  std::filesystem::path target_, part_;
  uint32_t frames_ = 0;
};

// frame.json's text; profiles inline. Numbers survive reading bit for bit.
std::string describe_frame(const FrameDescription& description);

} // namespace dermis::tools
