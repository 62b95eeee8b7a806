#include "passes/choice/tile_selection.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace dermis::choice {
namespace {

using Bins = std::array<uint32_t, selection_bins>;

bool is_kept(uint32_t priority) {
  return (priority & selection_kept_bit) != 0;
}

uint32_t bin_of(uint32_t priority) {
  const uint32_t change = priority & ((1u << selection_level_shift) - 1);
  const auto value = static_cast<float>(std::max(change, 1u));
  return std::min((std::bit_cast<uint32_t>(value) >> 20) - selection_first_bin, selection_bins - 1);
}

uint32_t steady_units(uint32_t units, uint32_t demand, uint32_t steady) {
  if (demand <= units) return units;
  return units / all_steady * steady + units % all_steady * steady / all_steady;
}

uint32_t next_steady(uint32_t steady, uint32_t units, uint32_t demand, uint32_t kept) {
  if (demand <= units || units == 0) return all_steady;
  const auto all = static_cast<int32_t>(units), limit = std::max(all / 8, 1);
  const int32_t free = std::clamp(all - static_cast<int32_t>(kept), -limit, limit);
  const int32_t next =
      static_cast<int32_t>(steady) + free * static_cast<int32_t>(steady_gain) / all;
  return static_cast<uint32_t>(
      std::clamp(next, static_cast<int32_t>(min_steady), static_cast<int32_t>(all_steady)));
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

TileState state_of(bool kept, bool stays, bool affordable) {
  if (stays && affordable) return TileState::shown;
  return kept ? TileState::fading : TileState::unscattered;
}

} // namespace

TileSelection select_tiles(std::span<const TileToSelect> tiles, uint32_t units, uint32_t steady) {
  TileSelection out;
  Bins all{}, fresh{}; // fresh: tiles that are not kept
  uint32_t kept = 0;
  for (const TileToSelect& tile : tiles) {
    if (!tile.scatters) continue;
    ++out.demand;
    ++all[bin_of(tile.priority)];
    if (is_kept(tile.priority))
      ++kept;
    else
      ++fresh[bin_of(tile.priority)];
  }
  out.steady = next_steady(steady, units, out.demand, kept);
  const Threshold staying = find_threshold(all, steady_units(units, out.demand, out.steady));
  const Threshold entering = find_threshold(fresh, units - std::min(kept, units));
  uint32_t earlier = 0, earlier_fresh = 0;
  for (const TileToSelect& tile : tiles) {
    TileState state = TileState::not_scattering;
    if (tile.scatters) {
      const uint32_t bin = bin_of(tile.priority);
      const bool stays = is_paid(staying, bin, earlier);
      const bool affordable = is_kept(tile.priority) || is_paid(entering, bin, earlier_fresh);
      state = state_of(is_kept(tile.priority), stays, affordable);
      out.units += state != TileState::unscattered ? 1 : 0;
    }
    out.states.push_back(state);
  }
  return out;
}

} // namespace dermis::choice
