#pragma once
// Divides each image of a plan into the smallest number of subresources such that the range of
// every access and barrier is a set of whole subresources.

#include "framegraph/compile/plan.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace dermis {

// Subresources of one resource: a grid of mips by layers, mips first. A buffer has one.
struct SubresourceGrid {
  std::vector<uint16_t> mips, layers; // first mip and first layer of each cell, then the end

  uint32_t count() const { return static_cast<uint32_t>((mips.size() - 1) * (layers.size() - 1)); }

  // Calls visit with the number of each cell that begins in the range.
  template <class Visit> void for_each_in(const SubresourceRange& range, Visit visit) const {
    const auto columns = static_cast<uint32_t>(layers.size() - 1);
    const auto [first_row, end_row] = between(mips, range.first_mip, range.mips);
    const auto [first_column, end_column] = between(layers, range.first_layer, range.layers);
    for (uint32_t m = first_row; m < end_row; ++m)
      for (uint32_t l = first_column; l < end_column; ++l)
        visit(m * columns + l);
  }

private:
  // Returns the first and the end of the grid rows or columns that begin within the range.
  static std::pair<uint32_t, uint32_t> between(const std::vector<uint16_t>& cuts, uint32_t first,
                                               uint32_t count) {
    const auto place = [&](uint32_t value) {
      return static_cast<uint32_t>(std::lower_bound(cuts.begin(), cuts.end() - 1, value) -
                                   cuts.begin());
    };
    return {place(first), place(first + count)};
  }
};

// Returns the grid of each resource. `plan` must pass verify_structure().
std::vector<SubresourceGrid> subresource_grids(const Plan& plan);

// Returns for each resource how many of its subresources an access or barrier uses.
std::vector<uint32_t> used_subresource_counts(const Plan& plan,
                                              const std::vector<SubresourceGrid>& grids);

// Returns whether the two ranges have a mip of a layer in common.
bool overlap(const SubresourceRange& a, const SubresourceRange& b);

} // namespace dermis
