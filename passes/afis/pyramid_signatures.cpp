// The plain pyramid: light times mask, halved level by level. Images have a border of two texels
// whose outer ring is always 0, so that filtered reads return 0 outside, unless `borders` says
// otherwise.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port setup_ports[] = {
    port::lighting,
    port::material,
    port::albedo,
    port::optional(port::depth),
    port::written("level_0", port::level_doc, port::light_formats),
};
constexpr std::string_view borders_options[] = {"both", "fine", "none"};
constexpr PassTypeSetting borders =
    setting::choice("borders", borders_options,
                    "images with a border of two texels: both, only the finer one, or none. "
                    "Without a border, sides "
                    "are multiples of 2");
constexpr std::string_view alpha_options[] = {"mask", "depth"};
constexpr PassTypeSetting alpha = setting::choice(
    "alpha", alpha_options,
    "content of alpha: mask, or view depth in metres (0: no surface), as published");
constexpr std::string_view profiles_options[] = {"merged", "apart"};
constexpr PassTypeSetting setup_settings[] = {
    setting::texturing,
    setting::choice(
        "profiles", profiles_options,
        "apart: for subsurface.afis; masks are scaled and mark texels that mix profiles"),
    borders,
    alpha,
};

constexpr Port down_ports[] = {
    port::level("fine"),
    port::written("coarse", port::level_doc, port::light_formats),
};

constexpr std::string_view halving_options[] = {"binomial", "box"};
constexpr PassTypeSetting down_settings[] = {
    setting::choice(
        "halving", halving_options,
        "binomial: [1 3 3 1] with four filtered reads; box: mean of 2x2 texels with one read"),
    borders,
    alpha,
    setting::integer("level", 15, 1, 15, "",
                     "level that the pass writes; needed if the sizes of the levels follow "
                     "square_view: the first levels of pixels that are not square halve one axis"),
};

} // namespace

const PassType pyramid_setup_type{
    .name = "subsurface.pyramid_setup",
    .shader = "afis/subsurface_pyramid_setup",
    .doc = "Writes level 0 of the plain pyramid: light times mask of every pixel, with a border of "
           "zeros.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = over_written_image,
};

const PassType pyramid_down_type{
    .name = "subsurface.pyramid_down",
    .shader = "afis/subsurface_pyramid_down",
    .doc =
        "Reduces a level of the plain pyramid to half its size, with a [1 3 3 1] or a box filter.",
    .ports = down_ports,
    .settings = down_settings,
    .dispatch = over_written_image,
};

} // namespace dermis::subsurface
