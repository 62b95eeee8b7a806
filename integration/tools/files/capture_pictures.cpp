#include "integration/tools/files/capture_pictures.hpp"

#include "framegraph/text/file_roots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace dermis::tools {

namespace fs = std::filesystem;

namespace {

std::optional<Image> read_sized(const fs::path& path, const std::vector<ChannelNames>& channels,
                                const Document& document, const FrameDescription& description,
                                std::span<const fs::path> roots, Diagnostics& diagnostics) {
  const PlacedFile placed = place_file(path.parent_path(), path.filename().string(), roots);
  if (!placed.problem.empty()) {
    diagnostics.add(DiagnosticId::outside_root, document.where(document.root()),
                    fmt::format("'{}' is not read: {}", path.string(), placed.problem));
    return std::nullopt;
  }
  std::string error;
  auto image = read_exr(path, channels, error);
  if (!image) {
    diagnostics.add(DiagnosticId::capture_picture, document.where(document.root()), error);
    return std::nullopt;
  }
  if (image->width != description.width || image->height != description.height) {
    diagnostics.add(
        DiagnosticId::capture_picture_size, document.where(document.find(document.root(), "width")),
        fmt::format("'{}' is {} x {}; frame.json says {} x {}", path.string(), image->width,
                    image->height, description.width, description.height));
    return std::nullopt;
  }
  return image;
}

// Warns of values of subsurface pixels that are replaced by 0.
void warn_of_replaced(const fs::path& path, const SanitisedCounts& of_image,
                      const Document& document, SanitisedCounts& all, Diagnostics& diagnostics) {
  all.not_finite += of_image.not_finite;
  all.negative += of_image.negative;
  if (of_image.not_finite + of_image.negative > 0)
    diagnostics.add(
        DiagnosticId::capture_sanitised, document.where(document.root()),
        fmt::format("'{}': {} values of subsurface pixels were not finite and {} negative; they "
                    "count as 0",
                    path.string(), of_image.not_finite, of_image.negative));
}

// Converts ids to bytes. A value that is not a whole number from 0 to 255 is an error, since no
// rounding is safe; NaN becomes 0.
void take_profile_ids(const Image& image, const fs::path& path, const Document& document,
                      CapturedFrame& frame, Diagnostics& diagnostics) {
  SanitisedCounts replaced;
  frame.profile.resize(image.values.size());
  for (size_t i = 0; i < image.values.size(); ++i) {
    float value = image.values[i];
    if (std::isnan(value)) {
      ++replaced.not_finite;
      value = 0;
    }
    if (value < 0 || value > 255 || value != std::floor(value)) {
      diagnostics.add(
          DiagnosticId::capture_profile, document.where(document.find(document.root(), "profiles")),
          fmt::format("'{}' holds {} at pixel ({}, {}); ids are whole numbers from 0 to 255",
                      path.string(), value, i % image.width, i / image.width));
      return;
    }
    frame.profile[i] = static_cast<uint8_t>(value);
  }
  warn_of_replaced(path, replaced, document, frame.sanitised, diagnostics);
}

void check_profiles_known(const Document& document, const CapturedFrame& frame,
                          Diagnostics& diagnostics) {
  std::array<uint64_t, 256> pixels{};
  std::array<size_t, 256> first{};
  for (size_t i = 0; i < frame.profile.size(); ++i)
    if (pixels[frame.profile[i]]++ == 0) first[frame.profile[i]] = i;
  for (const CaptureProfile& known : frame.description.profiles)
    pixels[known.id] = 0;
  for (uint32_t id = 1; id < pixels.size(); ++id)
    if (pixels[id] > 0)
      diagnostics.add(
          DiagnosticId::capture_profile, document.where(document.find(document.root(), "profiles")),
          fmt::format(
              "{} pixels have profile {}, which 'profiles' does not list; the first is at ({}, {})",
              pixels[id], id, first[id] % frame.description.width,
              first[id] / frame.description.width));
}

void refine_tiles(Image& image, bool signed_values, const std::vector<uint8_t>& profile,
                  SanitisedCounts& counts) {
  for (size_t i = 0; i < image.values.size(); ++i) {
    float& value = image.values[i];
    const bool finite = std::isfinite(value);
    if (finite && (signed_values || value >= 0)) continue;
    if (profile[i / image.channels] != 0) ++(finite ? counts.negative : counts.not_finite);
    value = 0;
  }
}

// Warns of light of subsurface pixels above max_light, which keeps its value.
void warn_of_bright(const fs::path& path, const Image& light, const std::vector<uint8_t>& profile,
                    const Document& document, Diagnostics& diagnostics) {
  uint64_t pixels = 0;
  float brightest = 0;
  for (size_t i = 0; i < profile.size() && !light.values.empty(); ++i) {
    const auto pixel = std::span(light.values).subspan(3 * i, 3);
    const float own = profile[i] != 0 ? std::ranges::max(pixel) : 0;
    if (own > max_light) ++pixels;
    brightest = std::max(brightest, own);
  }
  if (pixels > 0)
    diagnostics.add(DiagnosticId::capture_sanitised, document.where(document.root()),
                    fmt::format("'{}': light of {} subsurface pixels is above {}, at most {}; "
                                "graphs clamp it to {}: scale the light down before it is captured "
                                "(pre-exposure)",
                                path.string(), pixels, max_light, brightest, max_light));
}

} // namespace

const std::vector<PictureKind>& picture_kinds() {
  using Names = std::vector<ChannelNames>;
  static const std::vector<PictureKind> pass_types = {
      {"lighting", &CapturedFrame::lighting, true, false, Names{{"R", "G", "B"}}},
      {"depth", &CapturedFrame::depth, true, false, Names{{"Z"}, {"Y"}, {"R"}, {"*"}}},
      {"albedo", &CapturedFrame::albedo, false, false, Names{{"R", "G", "B"}}},
      {"normal", &CapturedFrame::normal, false, true, Names{{"X", "Y", "Z"}, {"R", "G", "B"}}},
      {"velocity", &CapturedFrame::velocity, false, true, Names{{"X", "Y"}, {"R", "G"}}},
      {"scatter_scale", &CapturedFrame::scatter_scale, false, false, Names{{"Y"}, {"R"}, {"*"}}},
      {"specular", &CapturedFrame::specular, false, false, Names{{"R", "G", "B"}}},
      {"thickness", &CapturedFrame::thickness, false, false, Names{{"Y"}, {"R"}, {"*"}}},
      {"back_lighting", &CapturedFrame::back_lighting, false, false, Names{{"R", "G", "B"}}},
  };
  return pass_types;
}

const std::vector<ChannelNames>& profile_channels() {
  static const std::vector<ChannelNames> channels = {{"Y"}, {"R"}, {"*"}};
  return channels;
}

void read_pictures(const fs::path& folder, const Document& document, CapturedFrame& frame,
                   Diagnostics& diagnostics, FileRoots roots) {
  std::vector<fs::path> readable(roots.begin(), roots.end());
  readable.insert(readable.begin(), folder);
  const fs::path profile_path = folder / "profile.exr";
  const auto ids = read_sized(profile_path, profile_channels(), document, frame.description,
                              readable, diagnostics);
  if (ids) {
    take_profile_ids(*ids, profile_path, document, frame, diagnostics);
    check_profiles_known(document, frame, diagnostics);
  }
  for (const PictureKind& kind : picture_kinds()) {
    const fs::path path = folder / (std::string(kind.name) + ".exr");
    std::error_code code;
    if (!kind.required && !fs::exists(path, code)) continue;
    auto image =
        read_sized(path, kind.channels, document, frame.description, readable, diagnostics);
    if (!image || !ids) continue;
    SanitisedCounts replaced;
    refine_tiles(*image, kind.signed_values, frame.profile, replaced);
    warn_of_replaced(path, replaced, document, frame.sanitised, diagnostics);
    frame.*kind.image = std::move(*image);
  }
  std::error_code code;
  const bool thickness = fs::exists(folder / "thickness.exr", code);
  if (thickness != fs::exists(folder / "back_lighting.exr", code))
    diagnostics.add(
        DiagnosticId::capture_picture, document.where(document.root()),
        fmt::format(
            "'thickness.exr' and 'back_lighting.exr' are only valid together; '{}' is missing",
            (folder / (thickness ? "back_lighting.exr" : "thickness.exr")).string()));
  warn_of_bright(folder / "lighting.exr", frame.lighting, frame.profile, document, diagnostics);
  warn_of_bright(folder / "back_lighting.exr", frame.back_lighting, frame.profile, document,
                 diagnostics);
}

} // namespace dermis::tools
