// The plain pyramid: light times mask, halved level by level. Every image has a border of two
// texels whose outer ring is always 0, so that filtered reads return 0 outside.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

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
constexpr PassTypeSetting setup_settings[] = {
    setting::texturing,
    setting::choice("profiles", profiles_options,
                    "apart: for subsurface.afis; masks are scaled and mark texels that mix profiles"),
};

constexpr Port down_ports[] = {
    level_port("fine"),
    {"coarse", Usage::storage_image_write, false, "image2D", level_doc, light_formats},
};

constexpr std::string_view halving_options[] = {"binomial", "box"};
constexpr PassTypeSetting down_settings[] = {
    setting::choice("halving", halving_options,
                    "binomial: [1 3 3 1] with four filtered reads; box: mean of 2x2 texels with one read"),
};

} // namespace

const PassType pyramid_setup_type{
    .name = "subsurface.pyramid_setup",
    .shader = "afis/subsurface_pyramid_setup",
    .doc = "Writes level 0 of the plain pyramid: light times mask of every pixel, with a border of zeros.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = over_written,
    .side_effects = false,
};

const PassType pyramid_down_type{
    .name = "subsurface.pyramid_down",
    .shader = "afis/subsurface_pyramid_down",
    .doc = "Reduces a level of the plain pyramid to half its size, with a [1 3 3 1] or a box filter.",
    .ports = down_ports,
    .settings = down_settings,
    .dispatch = over_written,
    .side_effects = false,
};

} // namespace dermis::subsurface
