#include "passes/choice/tile_selection.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace dermis::choice {
namespace {

using Bins = std::array<uint32_t, selection_bins>;

bool is_chosen(uint32_t weight) {
  return weight > 0 && weight <= full_tile_weight;
}

uint32_t bin_of(const TileToSelect& tile) {
  float priority = static_cast<float>(std::max(tile.change, 1u));
  if (is_chosen(tile.before)) priority *= selection_stay;
  return std::min((std::bit_cast<uint32_t>(priority) >> 20) - selection_first_bin,
                  selection_bins - 1);
}

uint32_t steady_units(uint32_t units, uint32_t demand) {
  return demand <= units ? units : units - (units + selection_reserve - 1) / selection_reserve;
}

// The bins above `bin` are paid in full, and the first `left` tiles of `bin`.
struct Threshold {
  int32_t bin = -1;
  uint32_t left = 0;
};

Threshold find_threshold(const Bins& tiles_of_bin, uint32_t units) {
  for (int32_t bin = static_cast<int32_t>(selection_bins) - 1; bin >= 0; --bin) {
    const uint32_t tiles = tiles_of_bin[static_cast<size_t>(bin)];
    if (tiles > units) return {bin, units};
    units -= tiles;
  }
  return {};
}

// Returns whether a tile of this bin is paid. `earlier` counts the tiles of the last bin so far.
bool is_paid(const Threshold& threshold, uint32_t bin, uint32_t& earlier) {
  if (static_cast<int32_t>(bin) != threshold.bin) return static_cast<int32_t>(bin) > threshold.bin;
  return earlier++ < threshold.left;
}

uint32_t next_weight(uint32_t before, bool stays, bool enters, bool fades, bool continues) {
  if (!is_chosen(before)) return !enters ? 0 : continues ? 1 : full_tile_weight;
  if (stays) return std::min(before + 1, full_tile_weight);
  return fades ? before - 1 : 0;
}

} // namespace

TileSelection select_tiles(std::span<const TileToSelect> tiles, uint32_t units, bool continues) {
  TileSelection out;
  Bins all{}, fresh{}; // fresh: tiles without a weight
  uint32_t fresh_tiles = 0;
  for (const TileToSelect& tile : tiles) {
    if (!tile.scatters) continue;
    ++out.demand;
    ++all[bin_of(tile)];
    if (is_chosen(tile.before)) continue;
    ++fresh[bin_of(tile)];
    ++fresh_tiles;
  }
  const uint32_t chosen = out.demand - fresh_tiles;
  const bool fades = chosen <= units;
  const Threshold staying = find_threshold(all, steady_units(units, out.demand));
  const Threshold entering = find_threshold(fresh, fades ? units - chosen : 0);
  uint32_t earlier = 0, earlier_fresh = 0;
  for (const TileToSelect& tile : tiles) {
    uint32_t weight = not_scattering;
    if (tile.scatters) {
      const uint32_t bin = bin_of(tile);
      const bool stays = is_paid(staying, bin, earlier);
      const bool affordable = !is_chosen(tile.before) && is_paid(entering, bin, earlier_fresh);
      weight = next_weight(tile.before, stays, stays && affordable, fades, continues);
      out.units += weight > 0 ? 1 : 0;
    }
    out.weights.push_back(weight);
  }
  return out;
}

} // namespace dermis::choice
