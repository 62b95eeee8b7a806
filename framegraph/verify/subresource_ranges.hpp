#pragma once
// Into which parts a plan's accesses and barriers divide its images: the fewest of which each range holds
// whole ones.

#include "framegraph/compile/plan.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace dermis {

// The parts of one resource: a grid of mips by layers, mips first. Buffers have one.
struct ResourceParts {
  std::vector<uint16_t> mips, layers; // where rows and columns begin, and the end

  uint32_t count() const { return static_cast<uint32_t>((mips.size() - 1) * (layers.size() - 1)); }

  // Calls with the number of each part that begins in the range.
  template <class Visit> void for_each_in(const SubresourceRange& range, Visit visit) const {
    const auto columns = static_cast<uint32_t>(layers.size() - 1);
    const auto [first_row, end_row] = between(mips, range.first_mip, range.mips);
    const auto [first_column, end_column] = between(layers, range.first_layer, range.layers);
    for (uint32_t m = first_row; m < end_row; ++m)
      for (uint32_t l = first_column; l < end_column; ++l)
        visit(m * columns + l);
  }

private:
  // Which rows or columns begin within the range.
  static std::pair<uint32_t, uint32_t> between(const std::vector<uint16_t>& cuts, uint32_t first,
                                               uint32_t count) {
    const auto place = [&](uint32_t value) {
      return static_cast<uint32_t>(std::lower_bound(cuts.begin(), cuts.end() - 1, value) - cuts.begin());
    };
    return {place(first), place(first + count)};
  }
};

// By resource. `plan` must pass verify_structure().
std::vector<ResourceParts> parts_of(const Plan& plan);

// By resource: how many of the parts any access or barrier touches.
std::vector<uint32_t> used_parts(const Plan& plan, const std::vector<ResourceParts>& parts);

// Have the two ranges a mip of a layer in common?
bool meet(const SubresourceRange& a, const SubresourceRange& b);

} // namespace dermis
