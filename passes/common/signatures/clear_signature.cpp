// Clears resources that later passes write only in part.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {
constexpr Port ports[] = {{"target", Usage::clear, false, "", "an image or a buffer, as a whole"}};
constexpr Format cleared_formats[] = {Format::r16f, Format::rg16f, Format::rgba16f,
                                      Format::r32f, Format::rg32f, Format::rgba32f};
constexpr Port clear_tiles_ports[] = {
    port::read_buffer("listed", "uint",
                      "per tile of the render rectangle: 0 if the list leaves the tile out "
                      "('classes' or 'samples_per_tile')"),
    port::written("target", "0 in all tiles that are not listed; undefined in the listed tiles",
                  cleared_formats),
};
} // namespace

const PassType clear_type{
    .name = "clear",
    .shader = "",
    .doc = "Fills an image or a buffer with zeros. Runs no kernel.",
    .ports = ports,
    .settings = {},
    .dispatch = no_dispatch,
};

const PassType clear_tiles_type{
    .name = "subsurface.clear_tiles",
    .shader = "common/subsurface_clear_tiles",
    .doc = "Clears an image in the tiles that a list leaves out, before a pass that writes all "
           "texels of the listed tiles. Faster than 'clear', which fills the image.",
    .ports = clear_tiles_ports,
    .settings = {},
    .dispatch = over_tile_blocks,
};

} // namespace dermis::subsurface
