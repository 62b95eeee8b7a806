#pragma once
// Settings that several pass types declare with the same meaning, and functions that declare
// others.

#include "framegraph/model/pass_type.hpp"
#include "passes/common/dispatch.hpp"

namespace dermis::subsurface::setting {

constexpr PassTypeSetting integer(std::string_view name, int64_t standard, double minimum,
                                  double maximum, std::string_view unit, std::string_view doc) {
  return {.name = name,
          .type = SettingType::integer,
          .default_value = {SettingType::integer, standard, 0},
          .minimum = minimum,
          .maximum = maximum,
          .unit = unit,
          .doc = doc};
}

constexpr PassTypeSetting real(std::string_view name, double standard, double minimum,
                               double maximum, std::string_view unit, std::string_view doc) {
  return {.name = name,
          .type = SettingType::real,
          .default_value = {SettingType::real, 0, standard},
          .minimum = minimum,
          .maximum = maximum,
          .unit = unit,
          .doc = doc};
}

// Declares a switch that is off by default.
constexpr PassTypeSetting boolean(std::string_view name, std::string_view doc) {
  return {.name = name,
          .type = SettingType::boolean,
          .default_value = {SettingType::boolean, 0, 0},
          .unit = "",
          .doc = doc};
}

// Declares a choice among `options`; options[standard] is the default.
constexpr PassTypeSetting choice(std::string_view name, std::span<const std::string_view> options,
                                 std::string_view doc, int64_t standard = 0,
                                 std::string_view unit = "") {
  return {.name = name,
          .type = SettingType::enumeration,
          .default_value = {SettingType::enumeration, standard, 0},
          .options = options,
          .unit = unit,
          .doc = doc};
}

// Allows a value per view, which may change every frame.
constexpr PassTypeSetting per_frame(PassTypeSetting setting) {
  setting.per_frame = true;
  return setting;
}

// Albedo.
inline constexpr std::string_view texturing_options[] = {"post", "pre_post", "pre", "demodulate"};
inline constexpr PassTypeSetting texturing = choice(
    "texturing", texturing_options,
    "where albedo is applied. post: after scattering (keeps texture detail); pre_post: its square "
    "root before and after; pre: before; demodulate: lighting already contains albedo, which is "
    "divided out before scattering and multiplied back after it");

inline constexpr std::string_view result_options[] = {"color", "light"};
inline constexpr PassTypeSetting result = choice(
    "result", result_options,
    "color: scattered light times albedo; light: only scattered light, for hosts that apply albedo "
    "later");

// Tiles in which the error is estimated.
inline constexpr PassTypeSetting probed_tiles =
    integer("tiles", 8, 1, max_probes, "tiles",
            "number of tiles per probed frame; the error is estimated at four pixels of each tile");
inline constexpr PassTypeSetting probe_interval =
    integer("interval", 1, 1, 256, "frames",
            "mean number of frames between probed frames, which are selected at random");

// Samples.
constexpr PassTypeSetting samples(int64_t standard, double minimum, std::string_view doc) {
  return integer("samples", standard, minimum, 4096, "samples per pixel", doc);
}
constexpr PassTypeSetting lod_bias(double standard) {
  return real("lod_bias", standard, -8, 4, "levels",
              "offset of the mip level; at 0 a texel has the area that a sample represents");
}
inline constexpr std::string_view inverse_options[] = {"polynomial", "exact", "approximate"};
inline constexpr std::string_view weighting_options[] = {"sampler", "profile"};
inline constexpr std::string_view direct_options[] = {"inscribed", "circumscribed", "none"};

// Refinement by samples where the confidence of a pyramid is below a threshold.
constexpr PassTypeSetting sample_weight(double standard) {
  return per_frame(real(
      "sample_weight", standard, 0, 16, "",
      "weight of 16 samples relative to the pyramid's light where the confidence is 0; falls in "
      "proportion to the confidence that is missing, and to the samples"));
}

} // namespace dermis::subsurface::setting
