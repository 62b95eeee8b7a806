#include "passes/choice/sample_allocation.hpp"

#include <algorithm>
#include <bit>

namespace dermis::choice {

uint32_t step_cost(int k) {
  return k < 2 ? 1 : 2;
}

int samples_of(uint32_t steps) {
  return steps == 0 ? 0 : 4 << steps;
}

uint32_t step_bin(uint32_t tile_error, int k, uint32_t before) {
  if (tile_error == 0) return no_bin;
  float priority = static_cast<float>(tile_error) * allocation_gain[static_cast<size_t>(k)];
  if (before > static_cast<uint32_t>(k)) priority *= allocation_stay;
  const auto bits = static_cast<int32_t>(std::bit_cast<uint32_t>(priority) >> 20);
  return static_cast<uint32_t>(
      std::clamp(bits - allocation_first_bin, 0, static_cast<int32_t>(allocation_bins) - 1));
}

SampleAllocation allocate_samples(std::span<const uint32_t> tile_errors,
                                  std::span<const uint32_t> before, uint32_t units) {
  const auto bin_of = [&](size_t tile, int k) {
    return step_bin(tile_errors[tile], k, before.empty() ? 0 : before[tile]);
  };
  std::array<uint32_t, allocation_bins> cost_of_bin{};
  for (size_t i = 0; i < tile_errors.size(); ++i)
    for (int k = 0; k < allocation_steps; ++k)
      if (const uint32_t bin = bin_of(i, k); bin != no_bin) cost_of_bin[bin] += step_cost(k);

  SampleAllocation out;
  for (const uint32_t cost : cost_of_bin)
    out.demand += cost;
  int32_t last_bin = static_cast<int32_t>(allocation_bins) - 1;
  uint32_t left = units;
  for (; last_bin >= 0 && cost_of_bin[static_cast<size_t>(last_bin)] <= left; --last_bin)
    left -= cost_of_bin[static_cast<size_t>(last_bin)];

  uint32_t spent = 0; // units of the last bin that earlier tiles requested
  for (size_t i = 0; i < tile_errors.size(); ++i) {
    uint32_t steps = 0;
    for (int k = 0; k < allocation_steps; ++k) {
      const uint32_t bin = bin_of(i, k);
      if (bin == no_bin) break;
      bool taken = static_cast<int32_t>(bin) > last_bin;
      if (static_cast<int32_t>(bin) == last_bin) {
        spent += step_cost(k);
        taken = spent <= left;
      }
      if (!taken) break;
      ++steps;
      out.units += step_cost(k);
    }
    out.steps.push_back(steps);
  }
  return out;
}

} // namespace dermis::choice
