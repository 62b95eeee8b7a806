// Refinement of the surface-aware pyramid where confidence is low, by samples of the surface
// around, read from the pyramid's own levels.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view result_doc = "rgb: scattered light; a: confidence";

constexpr auto blend_ports = join(
    port::sap_levels,
    std::array{port::own_texels(port::sap_scattered), port::classes, port::tiles, port::arguments,
               port::written("blended", result_doc, port::light_formats), port::sampling});

constexpr Format ratio_formats[] = {Format::rgba16f};
constexpr Format place_formats[] = {Format::rgba16f};
constexpr std::string_view ratio_doc =
    "rgb: running ratio of sampled light to the pyramid's light; a: number of samples in the ratio";
constexpr std::string_view place_doc = "view depth in metres; profile id; logarithmic light "
                                       "pattern in which the ratio was learned; mean square "
                                       "deviation of patterns. 0 where nothing was written";

constexpr Format global_light_formats[] = {Format::rgba32f};
constexpr std::string_view global_light_doc =
    "logarithm of the global change of luminance since the ratio was learned; odds that light with "
    "the "
    "learned pattern is the learned light; tolerance of patterns";

constexpr Port place = port::sampled("place", place_doc, place_formats);

constexpr Port global_light_ports[] = {
    port::sap_surface("surface"),
    port::sap_scattered,
    port::velocity,
    port::classes,
    place,
    port::written("luminance_change", global_light_doc, global_light_formats),
};

constexpr auto residual_ports =
    join(port::sap_levels,
         std::array{port::own_texels(port::sap_scattered),
                    port::sampled("luminance_change", global_light_doc, global_light_formats),
                    port::velocity, port::classes, port::sampled("ratio", ratio_doc, ratio_formats),
                    place, port::tiles, port::arguments,
                    port::written("refined", result_doc, port::light_formats),
                    port::written("ratio_out", ratio_doc, ratio_formats),
                    port::written_in_part("place_out", place_doc, place_formats), port::sampling});

constexpr PassTypeSetting samples =
    setting::samples(16, 1, "number of samples beyond the direct radius, where confidence is low");

constexpr PassTypeSetting global_light_settings[] = {
    setting::per_frame(
        setting::real("tolerance", 0.06, 0.001, 100, "",
                      "minimum change of the logarithm of a surface's light, relative to the "
                      "global change, that counts as a change")),
};

constexpr PassTypeSetting blend_settings[] = {
    samples,
    setting::lod_bias(-1.5),
    setting::per_frame(
        setting::real("below", 0.93, 0, 2, "", "confidence below which a pixel is sampled")),
    setting::sample_weight(0.05),
};

constexpr PassTypeSetting residual_settings[] = {
    samples,
    setting::lod_bias(-1.5),
    setting::per_frame(
        setting::real("below", 0.985, 0, 2, "", "confidence below which a pixel is sampled")),
    setting::per_frame(setting::real(
        "often_below", 0.85, 0, 2, "",
        "confidence below which a pixel is sampled in one of 4 frames instead of one of 16")),
    setting::sample_weight(2),
    setting::per_frame(setting::real("alpha", 0.2, 0.01, 1, "",
                                     "minimum weight of new samples in the running ratio")),
    setting::integer("eager", 6, 0, 64, "times samples",
                     "history below which a pixel takes twice the samples in every frame"),
};

constexpr HistoryWeight residual_mixes[] = {
    {"ratio_out", "alpha", HistoryWeight::By::fraction, 16}};

} // namespace

const PassType refine_type{
    .name = "subsurface.refine",
    .shader = "papers/subsurface_refine",
    .doc = "Blends the pyramid's light with samples where its confidence is low. Uses no history.",
    .ports = blend_ports,
    .settings = blend_settings,
    .dispatch = over_tiles,
};

const PassType global_light_change_type{
    .name = "subsurface.global_light_change",
    .shader = "papers/subsurface_global_light_change",
    .doc = "Estimates the global change of luminance, to distinguish flashing light from a "
           "different light.",
    .ports = global_light_ports,
    .settings = global_light_settings,
    .dispatch = single_group,
};

const PassType residual_type{
    .name = "subsurface.residual",
    .shader = "papers/subsurface_residual",
    .doc = "Multiplies the pyramid's light by the running ratio of sampled light to it where its "
           "confidence "
           "is low.",
    .ports = residual_ports,
    .settings = residual_settings,
    .dispatch = over_tiles,
    .mixes = residual_mixes,
};

} // namespace dermis::subsurface
