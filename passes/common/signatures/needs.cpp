#include "passes/common/signatures/needs.hpp"

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {
namespace {

constexpr uint32_t pixel = 1, tile = 8, cell = 32, region = 64;       // sides of squares
constexpr uint32_t word = 4, range = 16, reservoir = 64, domain = 32; // bytes
// dispatch: VkDispatchIndirectCommand and one word; level_heads: bytes.
constexpr uint32_t demand_run = 256, demand_bytes = 1024, histogram_bytes = 2048, weights = 64;
constexpr uint32_t dispatch = 16, levels = 9, level_heads = 1024;

constexpr PortNeed needs[] = {
    // Buffers first, because needs_of() returns only the buffers for steps of a pyramid.
    {"classes", tile, word},
    {"listed", tile, word},
    {"tiles", tile, word, word},
    {"tile_errors", tile, word},
    {"samples_per_tile", tile, word},
    {"tile_d", tile, word},
    {"needed", tile, word},
    {"vertical_tiles", tile, word, word},
    {"horizontal_tiles", tile, word, word},
    {"demand", demand_run, demand_bytes}, // 1,024 tiles cover at least as much
    {"before", tile, word},
    {"tile_changes", tile, word},
    {"tile_states", tile, word, word},
    {"states_before", tile, word, word},
    {"pixel_weights", tile, weights},
    {"pixel_weights_before", tile, weights},
    {"histogram", demand_run, histogram_bytes},
    {"selected_tiles", tile, word, word},
    {"selected_arguments", 0, 0, dispatch},
    {"reservoirs", pixel, reservoir},
    {"reservoirs_before", pixel, reservoir},
    {"merged", pixel, reservoir},
    {"domains_before", pixel, domain},
    {"domains", pixel, domain},
    {"lights_before", 0, 0, 64},
    {"lights_kept", 0, 0, 64},
    {"vertices", 0, 0, 32}, // one element of the host's scene
    {"indices", 0, 0, word},
    {"instances", 0, 0, 64},
    {"lights", 0, 0, 64},
    {"light_range", tile, range},
    {"light_cells", cell, range},
    // 8 words, and a word per tile of level 4 of the pyramid: at most one per 64x64 pixels.
    {"list_state", region, word, 8 * word},
    // Two entries per tile hold all levels, which together have a third more tiles.
    {"level_tiles", tile, range, level_heads},
    {"arguments", 0, 0, dispatch},
    {"vertical_arguments", 0, 0, dispatch},
    {"horizontal_arguments", 0, 0, dispatch},
    {"copy_arguments", 0, 0, dispatch},
    {"level_arguments", 0, 0, levels* dispatch},
    // A word per tile of levels 6 to 8. Such a tile has 512, 1024 or 2048 pixels; the border adds
    // less than twice as many, so that each level has at most one tile per square.
    {"computed_children", 256, 4 * word},

    {"lighting", pixel},
    {"depth", pixel},
    {"normal", pixel},
    {"material", pixel},
    {"albedo", pixel},
    {"scatter_scale", pixel},
    {"velocity", pixel},
    {"importance", pixel},
    {"thickness", pixel},
    {"back_lighting", pixel},
    {"lit", pixel},
    {"light", pixel},
    {"slope", pixel},
    {"surface", pixel},
    {"scattered", pixel},
    {"scattered_light", pixel},
    {"unscattered", pixel},
    {"blurred", pixel},
    {"view_depth", pixel},
    {"blended", pixel},
    {"refined", pixel},
    {"accumulated", pixel},
    {"sampling", pixel},
    {"sampled", pixel},
    {"tile_class", pixel},
    {"guide", pixel},
    {"guide_out", pixel},
    {"control", pixel},
    {"control_out", pixel},
    {"place", pixel},
    {"place_out", pixel},
    {"ratio", pixel},
    {"ratio_out", pixel},
    {"past", pixel},
    {"past_out", pixel},
    {"target", pixel},
    {"level_0", pixel},
    {"levels", 2},
    {"chain", pixel},
    {"coarse_surface", 2},
    {"coarse_scattered", 2},
    {"second_coarse_surface", 2},
    {"second_coarse_scattered", 2},
    {"level_1", 2},
    {"level_2", 4},
    {"level_3", 8},
    {"level_4", 16},
    {"level_5", 32},
    {"level_6", 64},
    {"level_7", 128},
    {"level_8", 256},
    {"light_1", 2},
    {"light_2", 4},
    {"light_3", 8},
    {"light_4", 16},
    {"light_5", 32},
    {"surface_1", 2},
    {"surface_2", 4},
    {"surface_3", 8},
    {"surface_4", 16},
    {"surface_5", 32},
};
constexpr size_t buffers = 40;
static_assert(needs[buffers].port == "lighting");

} // namespace

std::span<const PortNeed> needs_of(std::string_view pass_type) {
  if (pass_type == clear_type.name) return {};
  const bool step = pass_type == sap_setup_half_res_type.name || pass_type == sap_down_type.name ||
                    pass_type == sap_up_type.name || pass_type == pyramid_down_type.name ||
                    pass_type == sap_coarse_down_type.name || pass_type == sap_coarse_up_type.name;
  return std::span(needs).first(step ? buffers : std::size(needs));
}

} // namespace dermis::subsurface
