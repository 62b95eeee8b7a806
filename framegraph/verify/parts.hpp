#pragma once
// Into which parts a plan's accesses and barriers divide its images: the fewest of which each range holds
// whole ones.

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <vector>

namespace dermis {

// The parts of one resource: a grid of mips by layers, mips first. Buffers have one.
struct ResourceParts {
  std::vector<uint16_t> mips, layers; // where rows and columns begin, and the end

  uint32_t count() const { return static_cast<uint32_t>((mips.size() - 1) * (layers.size() - 1)); }

  SubresourceRange begin_of(uint32_t part) const { // its first mip of its first layer
    const auto columns = static_cast<uint32_t>(layers.size() - 1);
    return {mips[part / columns], 1, layers[part % columns], 1};
  }

  // Calls with the number of each part that begins in the range.
  template <class Visit> void for_each_in(const SubresourceRange& range, Visit visit) const {
    const auto columns = static_cast<uint32_t>(layers.size() - 1);
    for (uint32_t m = 0; m + 1 < mips.size(); ++m) {
      if (mips[m] < range.first_mip || mips[m] >= range.first_mip + range.mips) continue;
      for (uint32_t l = 0; l < columns; ++l)
        if (layers[l] >= range.first_layer && layers[l] < range.first_layer + range.layers)
          visit(m * columns + l);
    }
  }
};

// By resource. `plan` must pass verify_structure().
std::vector<ResourceParts> parts_of(const Plan& plan);

// Have the two ranges a mip of a layer in common?
bool meet(const SubresourceRange& a, const SubresourceRange& b);

} // namespace dermis
