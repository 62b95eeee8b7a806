// Refinement of the surface-aware pyramid where confidence is low, by samples of the surface
// around, read from the pyramid's own levels.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/level_ports.hpp"

namespace dermis::subsurface {

namespace {

using port::light_formats;

constexpr Port sure_light{"scattered",
                          Usage::sampled_image,
                          false,
                          "texture2D",
                          "output of the pyramid. rgb: scattered light; a: confidence",
                          light_formats};
constexpr Port own_sure_light{sure_light.name,
                              sure_light.usage,
                              sure_light.optional,
                              sure_light.glsl_type,
                              sure_light.doc,
                              sure_light.formats,
                              true};
constexpr Port classes{"classes", Usage::storage_buffer_read,      false,
                       "uint",    "output of subsurface.classify", {}};

constexpr Port blend_ports[] = {
    port::level_light("light"),
    port::level_light("light_1"),
    port::level_light("light_2"),
    port::level_light("light_3"),
    port::level_light("light_4"),
    port::level_light("light_5"),
    port::level_surface("surface"),
    port::level_surface("surface_1"),
    port::level_surface("surface_2"),
    port::level_surface("surface_3"),
    port::level_surface("surface_4"),
    port::level_surface("surface_5"),
    own_sure_light,
    classes,
    port::tiles,
    port::arguments,
    {"blended", Usage::storage_image_write, false, "image2D", "rgb: scattered light; a: confidence",
     light_formats},
    port::sampling,
};

constexpr Format ratio_formats[] = {Format::rgba16f};
constexpr Format place_formats[] = {Format::rgba16f};
constexpr std::string_view ratio_doc =
    "rgb: running ratio of sampled light to the pyramid's light; a: number of samples in the ratio";
constexpr std::string_view place_doc =
    "view depth in metres; profile id; logarithmic light pattern in which the ratio was learned; mean square "
    "deviation of patterns. 0 where nothing was written";

constexpr Format global_light_formats[] = {Format::rgba32f};
constexpr std::string_view global_light_doc =
    "logarithm of the global change in brightness since the ratio was learned; odds that light with the "
    "learned pattern is the learned light; tolerance of patterns";

constexpr Port brightness_ports[] = {
    port::level_surface("surface"),
    sure_light,
    port::velocity,
    classes,
    {"place", Usage::sampled_image, false, "texture2D", place_doc, place_formats},
    {"brightness", Usage::storage_image_write, false, "image2D", global_light_doc, global_light_formats},
};

constexpr Port residual_ports[] = {
    port::level_light("light"),
    port::level_light("light_1"),
    port::level_light("light_2"),
    port::level_light("light_3"),
    port::level_light("light_4"),
    port::level_light("light_5"),
    port::level_surface("surface"),
    port::level_surface("surface_1"),
    port::level_surface("surface_2"),
    port::level_surface("surface_3"),
    port::level_surface("surface_4"),
    port::level_surface("surface_5"),
    own_sure_light,
    {"brightness", Usage::sampled_image, false, "texture2D", global_light_doc, global_light_formats},
    port::velocity,
    classes,
    {"ratio", Usage::sampled_image, false, "texture2D", ratio_doc, ratio_formats},
    {"place", Usage::sampled_image, false, "texture2D", place_doc, place_formats},
    port::tiles,
    port::arguments,
    {"refined", Usage::storage_image_write, false, "image2D", "rgb: scattered light; a: confidence",
     light_formats},
    {"ratio_out", Usage::storage_image_write, false, "image2D", ratio_doc, ratio_formats},
    {"place_out", Usage::storage_image_update, false, port::part_of_cleared, place_doc, place_formats},
    port::sampling,
};

constexpr PassTypeSetting samples{.name = "samples",
                                  .type = SettingType::integer,
                                  .default_value = integer_value(16),
                                  .minimum = 1,
                                  .maximum = 4096,
                                  .options = {},
                                  .unit = "samples per pixel",
                                  .doc =
                                      "number of samples beyond the direct radius, where confidence is low"};
constexpr PassTypeSetting lod_bias =
    setting::real("lod_bias", -1.5, -8, 4, "levels",
                  "offset of the mip level; at 0 a texel has the area that a sample represents");

constexpr PassTypeSetting brightness_settings[] = {
    setting::per_frame(setting::real("tolerance", 0.06, 0.001, 100, "",
                                     "minimum change of the logarithm of a surface's light, relative to the "
                                     "global change, that counts as a change")),
};

constexpr PassTypeSetting blend_settings[] = {
    samples,
    lod_bias,
    setting::per_frame(setting::real("below", 0.8, 0, 2, "", "confidence below which a pixel is sampled")),
    setting::per_frame(setting::real("sample_weight", 0.5, 0, 1, "", "weight of the samples in the result")),
};

constexpr PassTypeSetting residual_settings[] = {
    samples,
    lod_bias,
    setting::per_frame(setting::real("below", 0.988, 0, 2, "", "confidence below which a pixel is sampled")),
    setting::per_frame(
        setting::real("often_below", 0.85, 0, 2, "",
                      "confidence below which a pixel is sampled in one of 4 frames instead of one of 16")),
    setting::per_frame(
        setting::real("alpha", 0.2, 0.01, 1, "", "minimum weight of new samples in the running ratio")),
    {.name = "eager",
     .type = SettingType::integer,
     .default_value = integer_value(6),
     .minimum = 0,
     .maximum = 64,
     .options = {},
     .unit = "times samples",
     .doc = "history below which a pixel takes twice the samples in every frame"},
};

constexpr HistoryWeight residual_mixes[] = {{"ratio_out", "alpha", HistoryWeight::By::fraction, 16}};

} // namespace

const PassType refine_type{
    .name = "subsurface.refine",
    .shader = "papers/subsurface_refine",
    .doc = "Blends the pyramid's light with samples where its confidence is low. Uses no history.",
    .ports = blend_ports,
    .settings = blend_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType global_light_change_type{
    .name = "subsurface.global_light_change",
    .shader = "papers/subsurface_global_light_change",
    .doc = "Estimates the global change in brightness, to distinguish flashing light from a different light.",
    .ports = brightness_ports,
    .settings = brightness_settings,
    .dispatch = single_group,
    .side_effects = false,
};

const PassType residual_type{
    .name = "subsurface.residual",
    .shader = "papers/subsurface_residual",
    .doc = "Multiplies the pyramid's light by the running ratio of sampled light to it where its confidence "
           "is low.",
    .ports = residual_ports,
    .settings = residual_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .mixes = residual_mixes,
};

} // namespace dermis::subsurface
