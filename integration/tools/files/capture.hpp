#pragma once
// The capture folder holds the inputs of a frame graph: per frame a frame.json and EXR images.
// docs/capture.md describes the format. `dermis render --capture` or a host engine writes captures.

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
  uint32_t id = 0; // 1..255, as in the `profile` image
  subsurface::Profile profile;
};

// Largest half float. Graphs clamp brighter light to this value.
inline constexpr float max_light = 65504;

// Counts of values repaired while reading. Only pixels with a profile are counted.
struct SanitisedCounts {
  uint64_t not_finite = 0; // NaN or infinite, set to 0
  uint64_t negative = 0;   // negative light, depth, albedo or scatter_scale, set to 0
};

// Contents of frame.json.
struct FrameDescription {
  uint32_t width = 0, height = 0; // size of the images, pixels
  Rectangle render;               // the part of the images that was rendered
  bool perspective = true;
  // Row-major, for column vectors; clip_from_view is without jitter. Right-handed: reading mirrors
  // the matrices and `normal` of files with a left-handed view space.
  subsurface::Matrix4 clip_from_view{}, view_from_world{}, previous_clip_from_view{},
      previous_view_from_world{};
  // Metres per pixel of hand-made orthographic captures; clip_from_view is derived from it.
  std::optional<double> pixel_pitch_m;
  double metres_per_unit = 1;
  std::array<double, 2> jitter_px{};
  uint64_t frame_index = 0;
  bool cut = false; // the camera jumped: histories of the frame before are of no use
  double exposure = 1;
  std::vector<CaptureProfile> profiles;
};

// Images have width * height pixels. An absent optional image has no values.
struct CapturedFrame {
  FrameDescription description;
  subsurface::PixelRays rays;     // of the render rectangle, metres
  Image lighting;                 // 3 channels: diffuse irradiance before albedo, linear
  Image depth;                    // 1 channel: view depth, metres; 0 is background
  std::vector<uint8_t> profile;   // profile id; 0 is no subsurface scattering
  Image albedo, normal, specular; // 3 channels each, optional
  // 2 channels, optional: current minus previous position, pixels, +x right, +y down. An optional
  // third channel, which files do not have, holds view depth in units.
  Image velocity;
  Image scatter_scale; // 1 channel, optional: factor of d
  // Optional, both or neither: distance that light from the back travels through the material,
  // metres (1 channel), and irradiance on the far side, linear (3 channels).
  Image thickness, back_lighting;
  SanitisedCounts sanitised;
};

// Additional folders that a capture may read from, next to its own folder and the profile folder.
// Links into these folders are followed.
using FileRoots = std::span<const std::string>;

// Returns the frames of a capture sorted by name: subfolders that hold a frame.json, or the folder
// itself. Returns an empty list and adds an error if there is no frame or a frame is a link out of
// `folder`. Thread: any, if `diagnostics` is not shared.
std::vector<std::filesystem::path> find_frames(const std::filesystem::path& folder,
                                               Diagnostics& diagnostics, FileRoots roots = {});

// Reads and checks one frame. A profile's "file" is relative to the folder of frame.json; a plain
// name means <profile_folder>/<name>.json. Damaged values are repaired, counted and reported as a
// warning. Returns nullopt and adds located errors if anything else is wrong.
std::optional<CapturedFrame> read_frame(const std::filesystem::path& folder,
                                        const std::filesystem::path& profile_folder,
                                        Diagnostics& diagnostics, FileRoots roots = {});

// Reads only frame.json; the images stay empty. `folder` is the folder of the document.
std::optional<CapturedFrame> read_description(const Document& document,
                                              const std::filesystem::path& folder,
                                              const std::filesystem::path& profile_folder,
                                              Diagnostics& diagnostics, FileRoots roots = {});

// Computes `rays` from the description, and clip_from_view from pixel_pitch_m if that is set.
// Returns false if the matrix is not a projection.
bool complete_projection(FrameDescription& description, subsurface::PixelRays& rays);

// Writes a capture atomically: into a temporary folder next to `folder`, which `finish` renames. An
// existing capture is replaced; any other non-empty folder is rejected. Without `finish` nothing is
// left on disk.
class CaptureWriter {
public:
  // Returns false and sets `error` if the folder cannot be used.
  bool begin(const std::filesystem::path& folder, std::string& error);
  bool add(const CapturedFrame& frame, std::string& error); // writes frame_0000, frame_0001, ...
  bool finish(std::string& error);

  CaptureWriter() = default;
  ~CaptureWriter();
  CaptureWriter(const CaptureWriter&) = delete;
  CaptureWriter& operator=(const CaptureWriter&) = delete;

private:
  std::filesystem::path target_, part_;
  uint32_t frames_ = 0;
};

// Returns the text of frame.json with inline profiles. Numbers survive reading bit for bit.
std::string describe_frame(const FrameDescription& description);

} // namespace dermis::tools
