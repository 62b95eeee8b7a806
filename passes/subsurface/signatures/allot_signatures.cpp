// Samples by tile: how far off each tile is expected to be, which tiles get samples, and the samples
// themselves.

#include "passes/subsurface/signatures/level_ports.hpp"

namespace dermis::subsurface {

namespace {

using port::light_formats;
constexpr Format mended_formats[] = {Format::rgba16f};
constexpr Format importance_formats[] = {Format::r8_unorm, Format::r16f, Format::r32f};
constexpr std::string_view doubts_doc =
    "by tile of the render rectangle: how far off it is expected to be, 0 = not at all";

constexpr KindSetting below = setting::per_frame(
    setting::real("below", 0.8, 0, 2, "", "confidence below which a pixel may be sampled"));

constexpr Port doubt_ports[] = {
    {"scattered", Usage::sampled_image, false, "texture2D",
     "of the pyramid; rgb scattered light, a = confidence", light_formats},
    {"light", Usage::sampled_image, true, "texture2D",
     "before it scattered: what did not change by that counts less; unbound: all counts alike",
     light_formats},
    port::material,
    {"importance", Usage::sampled_image, true, "texture2D",
     "how much an error matters to the host, 0 to 1; unbound: 1 everywhere", importance_formats},
    port::tiles,
    port::arguments,
    {"doubts", Usage::storage_buffer_write, false, "uint", doubts_doc, {}},
};
constexpr KindSetting doubt_settings[] = {below};

constexpr Port contrast_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "as subsurface.setup writes it", light_formats},
    port::material,
    {"importance", Usage::sampled_image, true, "texture2D",
     "how much an error matters to the host, 0 to 1; unbound: 1 everywhere", importance_formats},
    port::tiles,
    port::arguments,
    {"doubts", Usage::storage_buffer_write, false, "uint", doubts_doc, {}},
};
constexpr KindSetting contrast_settings[] = {
    setting::per_frame(setting::real(
        "least", 0.01, 0, 4, "",
        "mean distance from the tile's mean, of exposed luminance, below which light counts as even")),
};

constexpr Port allot_ports[] = {
    port::classes,
    {"doubts", Usage::storage_buffer_read, false, "uint", doubts_doc, {}},
    {"before", Usage::storage_buffer_read, true, "uint", "the shares of the frame before", {}},
    {"shares", Usage::storage_buffer_write, false, "uint", port::shares.doc, {}},
    {"tiles", Usage::storage_buffer_write, false, "uint", port::tiles.doc, {}},
    {"arguments", Usage::storage_buffer_write, false, "uint", port::arguments.doc, {}},
};

constexpr Port mend_ports[] = {
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
    port::classes,
    port::shares,
    port::tiles,
    port::arguments,
    {"scattered", Usage::storage_image_update, false, "image2D",
     "rgb scattered light, a = confidence; mended in place", mended_formats},
};
constexpr KindSetting mend_settings[] = {
    setting::real("lod_bias", -1.5, -8, 4, "levels",
                  "on the level whose texels have the area that a sample stands for"),
    below,
    setting::per_frame(setting::real("share", 0.5, 0, 1, "", "of the samples in the result")),
};

} // namespace

const PassKind doubt_kind{
    .name = "subsurface.doubt",
    .shader = "subsurface_doubt",
    .doc = "How far off each tile is expected to be: what the pyramid's confidence lacks, times light and "
           "importance.",
    .ports = doubt_ports,
    .settings = doubt_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassKind contrast_kind{
    .name = "subsurface.contrast",
    .shader = "subsurface_contrast",
    .doc = "How much light varies inside each tile, times importance.",
    .ports = contrast_ports,
    .settings = contrast_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassKind allot_kind{
    .name = "subsurface.allot",
    .shader = "subsurface_allot",
    .doc = "Gives tiles samples, those first that gain most for what they cost, until the frame's budget is "
           "spent.",
    .ports = allot_ports,
    .settings = {},
    .dispatch = DispatchShape::single_group,
    .side_effects = false,
};

const PassKind mend_kind{
    .name = "subsurface.mend",
    .shader = "subsurface_mend",
    .doc = "Blends samples into the pyramid's light where a tile was given some.",
    .ports = mend_ports,
    .settings = mend_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
