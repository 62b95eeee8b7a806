// Filtered importance sampling. Its levels come from a pyramid_setup that keeps profiles apart
// (`profiles`).

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port afis_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "output of subsurface.setup", port::light_formats},
    {"slope", Usage::sampled_image, false, "texture2D", "output of subsurface.setup", port::way_formats},
    port::level_port("level_1"),
    port::level_port("level_2"),
    port::level_port("level_3"),
    port::level_port("level_4"),
    port::level_port("level_5"),
    port::level_port("level_6"),
    port::level_port("level_7"),
    port::level_port("level_8"),
    port::material,
    port::depth,
    port::scatter_scale,
    port::tiles,
    port::arguments,
    port::scattered,
};

constexpr std::string_view sequence_options[] = {"continued", "hashed", "stratified"};
constexpr std::string_view channels_options[] = {"widest", "mixture"};
constexpr std::string_view inverse_options[] = {"polynomial", "exact", "approximate"};
constexpr std::string_view weighting_options[] = {"sampler", "profile"};
constexpr std::string_view surface_options[] = {"patch", "distance"};
constexpr std::string_view direct_options[] = {"inscribed", "circumscribed", "none"};
constexpr std::string_view estimator_options[] = {"self", "centred", "none"};
constexpr std::string_view mips_options[] = {"trilinear", "whole", "none"};

constexpr PassTypeSetting afis_settings[] = {
    {.name = "samples",
     .type = SettingType::integer,
     .default_value = integer_value(16),
     .minimum = 1,
     .maximum = 4096,
     .options = {},
     .unit = "samples per pixel",
     .doc = "number of samples beyond the direct radius"},
    {.name = "lod_bias",
     .type = SettingType::real,
     .default_value = {SettingType::real, 0, -1.0},
     .minimum = -8,
     .maximum = 4,
     .options = {},
     .unit = "levels",
     .doc = "offset of the mip level; at 0 a texel has the area that a sample represents"},
    setting::choice(
        "sequence", sequence_options,
        "sample sequence. continued: R2 continues from frame to frame; hashed: R2 restarts in each frame; "
        "stratified: stratified radii and golden angle, both shifted by R2 per frame"),
    setting::choice("channels", channels_options,
                    "channels whose radii are sampled: widest: the widest channel; mixture: the mean of all "
                    "channels, for Burley's profile"),
    setting::choice("inverse", inverse_options,
                    "inverse of the widest channel's distribution: polynomial (error below 0.5 %), exact, or "
                    "approximate (c = 2.5715)",
                    1),
    setting::choice(
        "weighting", weighting_options,
        "density that divides a sample: sampler: the sampler's own; profile: the profile's, as published"),
    setting::choice(
        "surface", surface_options,
        "patch: profile at the 3-D distance times the area of the surface patch; distance: without the area"),
    setting::choice("direct", direct_options,
                    "radius within which the pixel's own light is used: inscribed in the pixel, "
                    "circumscribed about it, or none"),
    setting::choice("estimator", estimator_options,
                    "normalisation. self: divide by the sum of weights; centred: add the pixel's own light "
                    "times (1 - sum of weights); none: no normalisation"),
    setting::choice("mips", mips_options,
                    "trilinear: interpolate between two levels; whole: round to one level; none: read only "
                    "the pixel under the sample"),
};

constexpr Format replaced_formats[] = {Format::rgba16f}; // formats that a shader may load
constexpr Port afis_tiles_ports[] = {
    afis_ports[0],
    afis_ports[1],
    port::level_port("level_1"),
    port::level_port("level_2"),
    port::level_port("level_3"),
    port::level_port("level_4"),
    port::level_port("level_5"),
    port::level_port("level_6"),
    port::level_port("level_7"),
    port::level_port("level_8"),
    port::material,
    port::depth,
    port::scatter_scale,
    port::classes,
    port::samples_per_tile,
    port::tiles,
    port::arguments,
    {"scattered", Usage::storage_image_update, false, "image2D",
     "scattered light of another technique; replaced in place", replaced_formats},
};

constexpr Format guide_formats[] = {Format::rgba16f};
constexpr Format place_formats[] = {Format::r16f};
constexpr std::string_view guide_doc =
    "standard deviation of one frame's exposed luminance; mean number of samples; depth in metres with "
    "split_half, otherwise moving mean of the monitored value; profile id. 0 where nothing was written";
constexpr std::string_view place_doc = "depth in metres; unused with split_half";
constexpr std::string_view control_doc = "weight of the control variate, its standard deviation, means of "
                                         "light and control variate; only with ocv";

constexpr Port guided_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "output of subsurface.setup", port::light_formats},
    {"slope", Usage::sampled_image, false, "texture2D", "output of subsurface.setup", port::way_formats},
    port::level_port("level_1"),
    port::level_port("level_2"),
    port::level_port("level_3"),
    port::level_port("level_4"),
    port::level_port("level_5"),
    port::level_port("level_6"),
    port::level_port("level_7"),
    port::level_port("level_8"),
    port::material,
    port::depth,
    port::scatter_scale,
    port::velocity,
    {"guide", Usage::sampled_image, false, "texture2D", guide_doc, guide_formats},
    {"place", Usage::sampled_image, true, "texture2D", place_doc, place_formats},
    {"control", Usage::sampled_image, true, "texture2D", control_doc, port::light_formats},
    port::tiles,
    port::arguments,
    port::scattered,
    {"guide_out", Usage::storage_image_update, false, port::part_of_cleared, guide_doc, guide_formats},
    {"place_out", Usage::storage_image_write, true, "image2D", place_doc, place_formats},
    {"control_out", Usage::storage_image_write, true, "image2D", control_doc, port::light_formats},
    port::sampling,
};

constexpr std::string_view guidance_options[] = {"split_half", "spvg", "ccv", "ocv"};
constexpr PassTypeSetting count_setting(std::string_view name, int64_t standard, std::string_view doc) {
  return {.name = name,
          .type = SettingType::integer,
          .default_value = integer_value(standard),
          .minimum = 2,
          .maximum = 4096,
          .options = {},
          .unit = "samples per pixel",
          .doc = doc};
}

constexpr PassTypeSetting guided_settings[] = {
    afis_settings[1],
    afis_settings[2],
    afis_settings[3],
    afis_settings[4],
    afis_settings[5],
    afis_settings[6],
    afis_settings[7],
    afis_settings[8],
    afis_settings[9],
    setting::choice("guidance", guidance_options,
                    "value whose variance guides the number of samples. split_half: difference of two half "
                    "sequences; spvg: luminance; ccv: luminance minus that of the pixel's own light; ocv: "
                    "the same with an optimal weight"),
    count_setting("min_samples", 8, "minimum number of samples"),
    count_setting("max_samples", 64, "maximum number of samples"),
    setting::per_frame(setting::real("sigma2_target", 1e-4, 1e-12, 1e6, "",
                                     "target variance of one frame's exposed luminance")),
    setting::per_frame(
        setting::real("kappa", 0.2, 0, 1, "", "rate at which the number of samples follows a change")),
    setting::per_frame(setting::real("eta", 0.2, 0.001, 1, "", "weight of a new frame in moving means")),
    setting::per_frame(setting::real("eta_cv", 0.005, 1e-7, 1, "",
                                     "weight of a new frame in the covariance with the control variate")),
    setting::per_frame(setting::real("eps_alpha", 1e-6, 1e-20, 1, "",
                                     "prior of the control variate's weight [exposed luminance squared]")),
    {.name = "full_precision",
     .type = SettingType::boolean,
     .default_value = {SettingType::boolean, 0, 0.0},
     .minimum = 0,
     .maximum = 0,
     .options = {},
     .unit = "",
     .doc = "control_out has 32 bits per channel"},
};

constexpr HistoryWeight guided_mixes[] = {{"guide_out", "eta"}, {"control_out", "eta_cv"}};

} // namespace

const PassType afis_tiles_type{
    .name = "subsurface.afis_tiles",
    .shader = "afis/subsurface_afis_tiles",
    .doc = "Filtered importance sampling in tiles that have samples: `samples` for the first step, twice as "
           "many for each further step.",
    .ports = afis_tiles_ports,
    .settings = afis_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType guided_type{
    .name = "subsurface.guided",
    .shader = "afis/subsurface_guided",
    .doc =
        "Filtered importance sampling whose number of samples follows from the variance of earlier frames.",
    .ports = guided_ports,
    .settings = guided_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .mixes = guided_mixes,
};

const PassType afis_type{
    .name = "subsurface.afis",
    .shader = "afis/subsurface_afis",
    .doc = "Filtered importance sampling: each sample reads the level of a masked mip chain that matches the "
           "sample density.",
    .ports = afis_ports,
    .settings = afis_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
