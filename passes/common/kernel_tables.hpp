#pragma once
// The static tables of descriptor set 1, all that a graph's passes need of them. They follow from the
// profiles and from which techniques the graph has, not from its size or settings: a graph that is resized or
// reloaded keeps them.

#include "passes/common/environment.hpp"

#include <span>
#include <vector>

namespace dermis::subsurface {

// Which fitted tables a graph's passes read.
struct TableUse {
  bool separable = false;
  PyramidUse pyramid;
  bool operator==(const TableUse&) const = default;
};

struct KernelTables {
  TableUse use;
  std::vector<ProfileEntry> profiles;
  std::vector<SeparableRow> separable;
  std::vector<float> pyramid;
  std::vector<RadialRow> radial;
};

TableUse table_use(const Graph& graph, const PassTypeRegistry& pass_types);
// Fits what is used: up to .2 s for the pyramids and .1 s a profile for separable. Thread: any.
KernelTables make_kernel_tables(const TableUse& use, std::span<const NumberedProfile> profiles);

} // namespace dermis::subsurface
