#include "integration/tools/files/capture.hpp"

#include "framegraph/text/file_roots.hpp"
#include "framegraph/text/limits.hpp"
#include "framegraph/text/reader.hpp"
#include "integration/tools/files/capture_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {

namespace fs = std::filesystem;

namespace {

constexpr double largest_number = 1e30;
constexpr double far_plane_m =
    1000; // Far plane of the matrix made from a pixel pitch, metres. No depth value depends on it.
constexpr subsurface::Matrix4 identity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

SourceLocation place_of(Diagnostics& diagnostics, const fs::path& path) {
  diagnostics.files.push_back({path.string(), {}});
  SourceLocation place;
  place.file = FileId{static_cast<uint32_t>(diagnostics.files.size() - 1)};
  return place;
}

void read_rectangle(const Document& document, ObjectReader& reader, FrameDescription& frame,
                    Diagnostics& diagnostics) {
  frame.render = {0, 0, frame.width, frame.height};
  const bool has_size = reader.ok();
  if (!reader.has("render_rectangle")) return;
  std::array<double, 4> r{};
  if (!reader.numbers("render_rectangle", r, 0, limits::image_side) || !has_size) return;
  const bool whole = std::all_of(r.begin(), r.end(), [](double v) { return v == std::floor(v); });
  if (!whole || r[2] < 1 || r[3] < 1 || r[0] + r[2] > frame.width || r[1] + r[3] > frame.height) {
    diagnostics.add(
        DiagnosticId::capture_rectangle,
        document.where(document.find(reader.node(), "render_rectangle")),
        fmt::format("[{}, {}, {}, {}] is not a rectangle of whole pixels inside {} x {}", r[0],
                    r[1], r[2], r[3], frame.width, frame.height));
    return;
  }
  frame.render = {uint32_t(r[0]), uint32_t(r[1]), uint32_t(r[2]), uint32_t(r[3])};
}

// Returns the matrices in the file's view space, which may be right- or left-handed.
subsurface::CameraMatrices read_matrices(ObjectReader& reader, bool has_pitch) {
  subsurface::CameraMatrices camera;
  reader.numbers("clip_from_view", camera.clip_from_view, -largest_number, largest_number,
                 has_pitch ? Need::optional : Need::required);
  camera.view_from_world = identity;
  reader.numbers("view_from_world", camera.view_from_world, -largest_number, largest_number,
                 Need::optional);
  camera.previous_clip_from_view = camera.clip_from_view;
  reader.numbers("previous_clip_from_view", camera.previous_clip_from_view, -largest_number,
                 largest_number, Need::optional);
  camera.previous_view_from_world = camera.view_from_world;
  reader.numbers("previous_view_from_world", camera.previous_view_from_world, -largest_number,
                 largest_number, Need::optional);
  return camera;
}

// A transposed matrix, as other engines store it, is not an error here: `validate --diagnose` finds
// it.
bool is_singular(const subsurface::Matrix4& m) {
  subsurface::Matrix4 transposed;
  for (size_t i = 0; i < m.size(); ++i)
    transposed[i] = m[i % 4 * 4 + i / 4];
  return !subsurface::invert_affine(m) && !subsurface::invert_affine(transposed);
}

bool is_projection(const subsurface::Matrix4& clip_from_view) {
  return subsurface::pixel_rays(clip_from_view, 1, 1, 1, {0, 0}).has_value();
}

// Returns whether the library accepts pixels of this shape.
bool has_usable_pixels(const subsurface::PixelRays& rays) {
  constexpr double most = 1e6; // dermis_graph_desc.pixel_aspect
  const double aspect = std::abs(rays.scale_x / rays.scale_y);
  return aspect >= 1 / most && aspect <= most;
}

void read_projection(const Document& document, ObjectReader& reader, CapturedFrame& captured,
                     subsurface::Handedness& handedness, Diagnostics& diagnostics) {
  FrameDescription& frame = captured.description;
  constexpr std::string_view pass_types[] = {"perspective", "orthographic"};
  constexpr std::string_view spaces[] = {"right_handed", "left_handed"};
  frame.perspective = reader.word("projection", pass_types).value_or(0) == 0;
  std::optional<subsurface::Handedness> declared;
  if (const auto space = reader.word("view_space", spaces, Need::optional))
    declared = *space == 1 ? subsurface::Handedness::left : subsurface::Handedness::right;
  constexpr double minimum = 1e-12, maximum = 1e12; // lengths, metres
  frame.pixel_pitch_m = reader.number("pixel_pitch_m", minimum, maximum, Need::optional);
  frame.metres_per_unit =
      reader.number("metres_per_unit", minimum, maximum, Need::optional).value_or(1);
  reader.numbers("jitter_px", frame.jitter_px, -1, 1, Need::optional);
  subsurface::CameraMatrices camera = read_matrices(reader, frame.pixel_pitch_m.has_value());
  const auto reject = [&](std::string_view key, std::string text) {
    diagnostics.add(DiagnosticId::capture_projection,
                    document.where(document.find(reader.node(), key)), std::move(text));
  };
  if (frame.pixel_pitch_m && frame.perspective)
    return reject("pixel_pitch_m",
                  "'pixel_pitch_m' is for orthographic captures; this one is perspective");
  if (frame.pixel_pitch_m && document.find(reader.node(), "clip_from_view").valid())
    return reject("pixel_pitch_m",
                  "'pixel_pitch_m' and 'clip_from_view' both describe the projection; give one");
  if (!reader.ok()) return;
  if (frame.pixel_pitch_m) {
    complete_projection(frame, captured.rays);
    camera.clip_from_view = declared == subsurface::Handedness::left
                                ? subsurface::with_mirrored_view(frame.clip_from_view)
                                : frame.clip_from_view;
    if (!document.find(reader.node(), "previous_clip_from_view").valid())
      camera.previous_clip_from_view = camera.clip_from_view;
  }
  const subsurface::CameraFault fault = subsurface::to_right_handed(camera, declared, handedness);
  frame.clip_from_view = camera.clip_from_view;
  frame.view_from_world = camera.view_from_world;
  frame.previous_clip_from_view = camera.previous_clip_from_view;
  frame.previous_view_from_world = camera.previous_view_from_world;
  const auto reject_singular = [&](std::string_view key) {
    reject(key, fmt::format("'{}' has no inverse that is affine", key));
  };
  if (is_singular(camera.view_from_world)) return reject_singular("view_from_world");
  if (is_singular(camera.previous_view_from_world))
    return reject_singular("previous_view_from_world");
  if (fault == subsurface::CameraFault::none && !is_projection(frame.previous_clip_from_view))
    return reject("previous_clip_from_view",
                  "'previous_clip_from_view' is not an axis-aligned projection");
  if (fault == subsurface::CameraFault::none && complete_projection(frame, captured.rays) &&
      captured.rays.perspective == frame.perspective) {
    if (!has_usable_pixels(captured.rays))
      reject("clip_from_view", "the pixels of 'clip_from_view' are more than 1000000 times as long "
                               "as wide, or as wide as long");
    return;
  }
  if (fault == subsurface::CameraFault::none || fault == subsurface::CameraFault::no_projection)
    return reject("clip_from_view",
                  fmt::format("'clip_from_view' is not an axis-aligned {} projection "
                              "(row-major, clip = M * view, Vulkan clip space)",
                              frame.perspective ? "perspective" : "orthographic"));
  const bool previous = fault == subsurface::CameraFault::previous_left ||
                        fault == subsurface::CameraFault::previous_right ||
                        fault == subsurface::CameraFault::previous_behind_camera;
  reject(
      previous ? "previous_clip_from_view" : "clip_from_view",
      fmt::format("{}; the camera looks down -z, or along +z with \"view_space\": \"left_handed\"",
                  subsurface::text_of(fault)));
}

// Converts normals of a left-handed view space, which point the other way along z.
void mirror_normals(Image& normal) {
  for (size_t i = 2; i < normal.values.size(); i += normal.channels)
    normal.values[i] = -normal.values[i];
}

std::optional<subsurface::Profile> read_profile_file(const Document& document, NodeId key,
                                                     const fs::path& folder,
                                                     const fs::path& profile_folder,
                                                     FileRoots roots, Diagnostics& diagnostics) {
  const fs::path name{std::string(document.text(key))};
  const bool plain = !name.has_parent_path() && name.extension().empty();
  std::vector<fs::path> readable(roots.begin(), roots.end());
  readable.insert(readable.begin(), {folder, profile_folder});
  const PlacedFile placed = plain ? place_file(profile_folder, name.string() + ".json", readable)
                                  : place_file(folder, name.string(), readable);
  if (!placed.problem.empty()) {
    diagnostics.add(DiagnosticId::outside_root, document.where(key),
                    fmt::format("profile '{}' is not read: {}", name.string(), placed.problem));
    return std::nullopt;
  }
  const std::string path = placed.path.string();
  std::error_code code;
  if (!fs::is_regular_file(path, code)) {
    diagnostics.add(
        DiagnosticId::capture_profile, document.where(key),
        fmt::format("profile '{}' does not exist: there is no file '{}'", name.string(), path));
    return std::nullopt;
  }
  const auto profile = read_document(path, diagnostics);
  return profile ? subsurface::read_profile(*profile, diagnostics) : std::nullopt;
}

void read_profiles(const Document& document, ObjectReader& reader, const fs::path& folder,
                   const fs::path& profile_folder, FileRoots roots, FrameDescription& frame,
                   Diagnostics& diagnostics) {
  const NodeId list = reader.array("profiles", 0, 255);
  if (!list.valid()) return;
  std::array<NodeId, 256> taken{};
  for (const NodeId node : children(document, list)) {
    const std::string what = fmt::format("profile {}", document[node].index);
    if (!expect_kind(document, node, what, NodeKind::object, diagnostics)) continue;
    const NodeId id_node = document.find(node, "id");
    const NodeId file = document.find(node, "file");
    std::optional<subsurface::Profile> profile;
    if (file.valid()) {
      ObjectReader object(document, node, what, diagnostics);
      object.any("id");
      if (object.string("file") && object.finish())
        profile = read_profile_file(document, file, folder, profile_folder, roots, diagnostics);
    } else {
      profile = subsurface::read_inline_profile(document, node, what, diagnostics);
    }
    if (!id_node.valid()) continue;
    const auto id =
        read_integer(document, id_node, fmt::format("'id' of {}", what), 1, 255, diagnostics);
    if (!id) continue;
    NodeId& first = taken[static_cast<size_t>(*id)];
    if (first.valid()) {
      diagnostics
          .add(DiagnosticId::capture_profile, document.where(id_node),
               fmt::format("id {} is declared twice", *id))
          .related.emplace_back(document.where(first), "first here");
    }
    first = id_node;
    if (profile) frame.profiles.push_back({static_cast<uint32_t>(*id), *profile});
  }
}

// Implements read_description, and also returns the `handedness` of the file's view space.
std::optional<CapturedFrame> read_view(const Document& document, const fs::path& folder,
                                       const fs::path& profile_folder, Diagnostics& diagnostics,
                                       FileRoots roots, subsurface::Handedness& handedness) {
  const uint64_t errors = diagnostics.errors();
  if (!check_version(document, "dermis_capture", capture_format_version, diagnostics))
    return std::nullopt;
  CapturedFrame frame;
  FrameDescription& description = frame.description;
  ObjectReader reader(document, document.root(), "frame", diagnostics);
  reader.has("dermis_capture");
  description.width =
      static_cast<uint32_t>(reader.integer("width", 1, limits::image_side).value_or(0));
  description.height =
      static_cast<uint32_t>(reader.integer("height", 1, limits::image_side).value_or(0));
  read_rectangle(document, reader, description, diagnostics);
  read_projection(document, reader, frame, handedness, diagnostics);
  const int64_t index = reader.integer("frame_index", 0, INT64_MAX, Need::optional).value_or(0);
  description.frame_index = static_cast<uint64_t>(index);
  description.cut = reader.boolean("cut", Need::optional).value_or(false);
  description.exposure = reader.number("exposure", 1e-12, 1e12, Need::optional).value_or(1);
  read_profiles(document, reader, folder, profile_folder, roots, description, diagnostics);
  reader.finish();
  if (diagnostics.errors() != errors) return std::nullopt;
  return frame;
}

} // namespace

std::vector<fs::path> find_frames(const fs::path& folder, Diagnostics& diagnostics,
                                  FileRoots roots) {
  std::vector<fs::path> frames, readable(roots.begin(), roots.end());
  readable.insert(readable.begin(), folder);
  std::error_code code;
  if (fs::is_regular_file(folder / "frame.json", code)) return {folder};
  for (fs::directory_iterator it(folder, code), end; !code && it != end; it.increment(code)) {
    std::error_code ignored;
    if (it->path().filename().string()[0] != '.' &&
        fs::is_regular_file(it->path() / "frame.json", ignored))
      frames.push_back(it->path());
  }
  std::sort(frames.begin(), frames.end());
  for (const fs::path& frame : frames) {
    const PlacedFile placed = place_file(folder, frame.filename().string(), readable);
    if (placed.problem.empty()) continue;
    diagnostics.add(DiagnosticId::outside_root, place_of(diagnostics, frame),
                    fmt::format("the frame '{}' is not read: {}", frame.string(), placed.problem));
    return {};
  }
  if (frames.empty())
    diagnostics.add(
        DiagnosticId::capture_empty, place_of(diagnostics, folder),
        fmt::format("the folder '{}' is not a capture: it contains neither frame.json nor "
                    "folders with frame.json{}",
                    folder.string(), code ? " (" + code.message() + ")" : ""));
  return frames;
}

bool complete_projection(FrameDescription& frame, subsurface::PixelRays& rays) {
  if (frame.pixel_pitch_m) {
    const double pitch = *frame.pixel_pitch_m;
    frame.metres_per_unit = 1;
    frame.clip_from_view = {2 / (frame.render.width * pitch),
                            0,
                            0,
                            0,
                            0,
                            -2 / (frame.render.height * pitch),
                            0,
                            0,
                            0,
                            0,
                            -1 / far_plane_m,
                            0,
                            0,
                            0,
                            0,
                            1};
  }
  const auto found =
      subsurface::pixel_rays(frame.clip_from_view, frame.render.width, frame.render.height,
                             frame.metres_per_unit, frame.jitter_px);
  if (!found) return false;
  rays = *found;
  return true;
}

std::optional<CapturedFrame> read_frame(const fs::path& folder, const fs::path& profile_folder,
                                        Diagnostics& diagnostics, FileRoots roots) {
  const auto document = read_document((folder / "frame.json").string(), diagnostics);
  if (!document) return std::nullopt;
  const uint64_t errors = diagnostics.errors();
  subsurface::Handedness handedness = subsurface::Handedness::right;
  std::optional<CapturedFrame> frame =
      read_view(*document, folder, profile_folder, diagnostics, roots, handedness);
  if (frame) read_pictures(folder, *document, *frame, diagnostics, roots);
  if (diagnostics.errors() != errors) return std::nullopt;
  if (handedness == subsurface::Handedness::left) mirror_normals(frame->normal);
  return frame;
}

std::optional<CapturedFrame> read_description(const Document& document, const fs::path& folder,
                                              const fs::path& profile_folder,
                                              Diagnostics& diagnostics, FileRoots roots) {
  subsurface::Handedness handedness = subsurface::Handedness::right;
  return read_view(document, folder, profile_folder, diagnostics, roots, handedness);
}

} // namespace dermis::tools
