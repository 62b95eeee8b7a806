// The plain pyramid: light times mask, halved level by level, read through cubic B-splines. Every image has a
// border of two texels whose outer ring is always 0, so that filtered reads find nothing outside.

#include "passes/subsurface/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

using port::level_doc;
using port::level_port;
using port::light_formats;

constexpr Port setup_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats},
    port::material,
    port::albedo,
    {"level_0", Usage::storage_image_write, false, "image2D", level_doc, light_formats},
};
constexpr std::string_view profiles_options[] = {"merged", "apart"};
constexpr KindSetting setup_settings[] = {
    setting::texturing,
    setting::choice("profiles", profiles_options,
                    "apart: for subsurface.afis; masks are scaled, and mark texels that mix profiles"),
};

constexpr Port down_ports[] = {
    level_port("fine"),
    {"coarse", Usage::storage_image_write, false, "image2D", level_doc, light_formats},
};

constexpr std::string_view halving_options[] = {"binomial", "box"};
constexpr KindSetting down_settings[] = {
    setting::choice("halving", halving_options,
                    "binomial: [1 3 3 1], four filtered reads; box: the mean of 2x2, one"),
};

constexpr Port gather_ports[] = {
    level_port("level_0"), level_port("level_1"), level_port("level_2"), level_port("level_3"),
    level_port("level_4"), level_port("level_5"), level_port("level_6"), level_port("level_7"),
    level_port("level_8"), port::material,        port::depth,           port::scatter_scale,
    port::tiles,           port::arguments,       port::scattered,
};

} // namespace

const PassKind pyramid_setup_kind{
    .name = "subsurface.pyramid_setup",
    .shader = "subsurface_pyramid_setup",
    .doc = "Level 0 of the plain pyramid: light times mask of every pixel, a border of zeros around it.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = DispatchShape::over_written,
    .side_effects = false,
};

const PassKind pyramid_down_kind{
    .name = "subsurface.pyramid_down",
    .shader = "subsurface_pyramid_down",
    .doc = "Halves a level of the plain pyramid with [1 3 3 1] or a box.",
    .ports = down_ports,
    .settings = down_settings,
    .dispatch = DispatchShape::over_written,
    .side_effects = false,
};

const PassKind pyramid_gather_kind{
    .name = "subsurface.pyramid_gather",
    .shader = "subsurface_pyramid_gather",
    .doc =
        "Sums the plain pyramid's levels by each listed pixel's own weights. Knows neither depth nor other "
        "profiles.",
    .ports = gather_ports,
    .settings = {},
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
