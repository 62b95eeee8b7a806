// Which 8x8 tiles hold subsurface, and the list of them that indirect dispatches run over.

#include "passes/subsurface/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port classify_ports[] = {
    port::material,
    port::depth,
    port::scatter_scale,
    {"classes",
     Usage::storage_buffer_write,
     false,
     "uint",
     "per tile of the render rectangle, row by row: 0 = no subsurface, 1 = scatters, 2 = below a pixel "
     "(copy)",
     {}},
};

constexpr Port tile_list_ports[] = {
    {"classes", Usage::storage_buffer_read, false, "uint", "as subsurface.classify writes them", {}},
    {"tiles", Usage::storage_buffer_write, false, "uint", port::tiles.doc, {}},
    {"arguments", Usage::storage_buffer_write, false, "uint", port::arguments.doc, {}},
};

} // namespace

const PassKind classify_kind{
    .name = "subsurface.classify",
    .shader = "subsurface_classify",
    .doc = "Classifies 8x8 tiles by material and projected scattering radius.",
    .ports = classify_ports,
    .settings = {},
    .dispatch = DispatchShape::over_view,
    .side_effects = false,
};

const PassKind tile_list_kind{
    .name = "subsurface.tile_list",
    .shader = "subsurface_tile_list",
    .doc = "Compacts tile classes into a list in row order and the indirect arguments for it (a scan without "
           "atomics: "
           "the same classes give the same list).",
    .ports = tile_list_ports,
    .settings = {},
    .dispatch = DispatchShape::single_group,
    .side_effects = false,
};

} // namespace dermis::subsurface
