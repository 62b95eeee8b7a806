// Filtered importance sampling. Its levels come from a pyramid_setup that keeps profiles apart
// (`profiles`).

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::array surface{port::material, port::depth, port::scatter_scale};

constexpr Port levels = port::filtered(port::sampled(
    "levels", "mip l - 1 is level l: rgb: light times mask; a: scaled mask, as pyramid_setup says",
    port::light_formats));

constexpr auto afis_ports = join(std::array{port::light, port::slope, levels}, surface,
                                 std::array{port::tiles, port::arguments, port::scattered});

constexpr auto afis_tiles_ports =
    join(std::array{port::light, port::slope, levels}, surface,
         std::array{port::classes, port::samples_per_tile, port::tiles, port::arguments,
                    port::updated("scattered",
                                  "scattered light of another technique; replaced in place")});

constexpr Port blend_tiles_ports[] = {
    port::sampled("sampled", "light of the tiles with samples", port::light_formats),
    port::material,
    port::classes,
    port::samples_per_tile,
    port::tiles,
    port::arguments,
    port::updated("scattered", "scattered light of another technique; replaced in place"),
};

constexpr std::string_view sequence_options[] = {"continued", "hashed", "stratified"};
constexpr std::string_view channels_options[] = {"widest", "mixture"};
constexpr std::string_view surface_options[] = {"patch", "distance"};
constexpr std::string_view estimator_options[] = {"self", "centred", "none"};
constexpr std::string_view mips_options[] = {"trilinear", "whole", "none"};

// Settings of the estimator, without the number of samples.
constexpr std::array estimator_settings{
    setting::lod_bias(-1.0),
    setting::choice("sequence", sequence_options,
                    "sample sequence. continued: R2 continues from frame to frame; hashed: R2 "
                    "restarts in each frame; "
                    "stratified: stratified radii and golden angle, both shifted by R2 per frame"),
    setting::choice(
        "channels", channels_options,
        "channels whose radii are sampled: widest: the widest channel; mixture: the mean of all "
        "channels, for Burley's profile"),
    setting::choice(
        "inverse", setting::inverse_options,
        "inverse of the widest channel's distribution: polynomial (error below 0.5 %), exact, or "
        "approximate (c = 2.5715)",
        1),
    setting::choice("weighting", setting::weighting_options,
                    "probability density by which a sample is divided. sampler: that of the "
                    "sampler; profile: that of the profile, as published"),
    setting::choice("surface", surface_options,
                    "patch: profile at the 3-D distance times the area of the surface patch; "
                    "distance: without the area"),
    setting::choice("direct", setting::direct_options,
                    "radius within which the pixel's own light is used: inscribed in the pixel, "
                    "circumscribed about it, or none"),
    setting::choice(
        "estimator", estimator_options,
        "normalisation. self: divide by the sum of weights; centred: add the pixel's own light "
        "times (1 - sum of weights); none: no normalisation"),
    setting::choice(
        "mips", mips_options,
        "trilinear: interpolate between two levels; whole: round to one level; none: read only "
        "the pixel under the sample"),
};

constexpr auto afis_settings =
    join(std::array{setting::samples(16, 1, "number of samples beyond the direct radius")},
         estimator_settings);

constexpr Format guide_formats[] = {Format::rgba16f};
constexpr Format place_formats[] = {Format::r16f};
constexpr std::string_view guide_doc = "standard deviation of one frame's exposed luminance; mean "
                                       "number of samples; depth in metres with "
                                       "split_half, otherwise moving mean of the monitored value; "
                                       "profile id. 0 where nothing was written";
constexpr std::string_view place_doc = "depth in metres; unused with split_half";
constexpr std::string_view control_doc =
    "weight of the control variate, its standard deviation, means of "
    "light and control variate; only with ocv";

constexpr auto guided_ports =
    join(std::array{port::light, port::slope, levels}, surface,
         std::array{port::velocity, port::sampled("guide", guide_doc, guide_formats),
                    port::optional(port::sampled("place", place_doc, place_formats)),
                    port::optional(port::sampled("control", control_doc, port::light_formats)),
                    port::optional(port::samples_per_tile), port::tiles, port::arguments,
                    port::scattered, port::written_in_part("guide_out", guide_doc, guide_formats),
                    port::optional(port::written("place_out", place_doc, place_formats)),
                    port::optional(port::written("control_out", control_doc, port::light_formats)),
                    port::sampling});

constexpr std::string_view guidance_options[] = {"split_half", "spvg", "ccv", "ocv"};
constexpr std::string_view control_options[] = {"mean", "own"};
constexpr std::string_view pool_options[] = {"tile", "pixel"};
constexpr auto guided_settings = join(
    estimator_settings,
    std::array{
        setting::choice(
            "guidance", guidance_options,
            "value whose variance guides the number of samples. split_half: difference of two half "
            "sequences; spvg: luminance of the light from beyond the direct radius; ccv: the same "
            "minus the control; ocv: the same with an optimal weight of the control"),
        setting::choice("control", control_options,
                        "for ccv and ocv. mean: mean light around the pixel, read from a level; "
                        "own: the pixel's own light, as published"),
        setting::per_frame(setting::real("control_level", 1, -4, 8, "levels",
                                         "level of the mean above log2 of d in pixels")),
        setting::choice("pool", pool_options,
                        "tile: variance and number of samples are means over the pixels of a "
                        "profile in a tile; pixel: as published; unused with split_half"),
        setting::per_frame(
            setting::real("eps_u", 0.01, 0.01, 1, "",
                          "fraction of the widest channel's light beyond the circumscribed radius, "
                          "below which light is copied; classify copies below 0.01")),
        setting::per_frame(setting::integer("first_samples", 16, 2, 4096, "samples per pixel",
                                            "number of samples of a pixel without history, within "
                                            "min_samples and max_samples")),
        setting::integer("min_samples", 8, 2, 4096, "samples per pixel",
                         "minimum number of samples"),
        setting::integer("max_samples", 64, 2, 4096, "samples per pixel",
                         "maximum number of samples"),
        setting::per_frame(setting::real("sigma2_target", 1e-4, 1e-12, 1e6, "",
                                         "target variance of one frame's exposed luminance")),
        setting::per_frame(setting::real("kappa", 0.2, 0, 1, "",
                                         "rate at which the number of samples follows a change")),
        setting::per_frame(
            setting::real("eta", 0.2, 0.001, 1, "", "weight of a new frame in moving means")),
        setting::per_frame(
            setting::real("eta_cv", 0.005, 1e-7, 1, "",
                          "weight of a new frame in the covariance with the control variate")),
        setting::per_frame(
            setting::real("eps_alpha", 1e-6, 1e-20, 1, "",
                          "prior of the control variate's weight [exposed luminance squared]")),
        setting::boolean("full_precision", "control_out has 32 bits per channel"),
    });

constexpr HistoryWeight guided_mixes[] = {{"guide_out", "eta"}, {"control_out", "eta_cv"}};

constexpr auto published_ports = std::array{
    port::filtered(port::sampled("chain", "mip l: light, with view depth in metres in alpha",
                                 port::light_formats)),
    port::material,
    port::scatter_scale,
    port::tiles,
    port::arguments,
    port::scattered};
constexpr PassTypeSetting published_settings[] = {
    setting::samples(16, 1, "number of samples beyond the direct radius"),
    setting::lod_bias(-1.0),
};

} // namespace

const PassType afis_published_type{
    .name = "subsurface.afis_published",
    .shader = "papers/subsurface_afis_published",
    .doc = "Filtered importance sampling of a chain of mips with depth in alpha, as published: one "
           "read per sample.",
    .ports = published_ports,
    .settings = published_settings,
    .dispatch = over_tiles,
};

const PassType afis_tiles_type{
    .name = "subsurface.afis_tiles",
    .shader = "afis/subsurface_afis_tiles",
    .doc = "Filtered importance sampling in tiles that have samples: `samples` for the first step, "
           "twice as "
           "many for each further step.",
    .ports = afis_tiles_ports,
    .settings = afis_settings,
    .dispatch = over_tiles,
};

const PassType blend_tiles_type{
    .name = "subsurface.blend_tiles",
    .shader = "afis/subsurface_blend_tiles",
    .doc =
        "Replaces the light of another technique in tiles that have samples, and blends both next "
        "to tiles without samples.",
    .ports = blend_tiles_ports,
    .settings = {},
    .dispatch = over_tiles,
};

const PassType guided_type{
    .name = "subsurface.guided",
    .shader = "afis/subsurface_guided",
    .doc = "Filtered importance sampling whose number of samples follows from the variance of "
           "earlier frames.",
    .ports = guided_ports,
    .settings = guided_settings,
    .dispatch = over_tiles,
    .mixes = guided_mixes,
};

const PassType afis_type{
    .name = "subsurface.afis",
    .shader = "afis/subsurface_afis",
    .doc = "Filtered importance sampling: each sample reads the level of a masked mip chain that "
           "matches the "
           "sample density.",
    .ports = afis_ports,
    .settings = afis_settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
