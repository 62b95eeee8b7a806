#pragma once
// All static tables of descriptor set 1 that a graph's passes need. They depend on the profiles and
// on the graph's techniques, not on its size or settings: a graph that is resized or reloaded keeps
// them.

#include "passes/common/environment.hpp"

#include <span>
#include <vector>

namespace dermis::subsurface {

// The fitted tables that a graph's passes read.
struct TableUse {
  bool separable = false;
  PyramidUse pyramid;
  bool operator==(const TableUse&) const = default;
};

struct KernelTables {
  TableUse use;
  std::vector<ProfileEntry> profiles;
  std::vector<SeparableRow> separable;
  std::vector<float> pyramid; // shared tables, then the profiles' own
  size_t shared_floats = 0;   // in `pyramid`
  std::vector<RadialRow> radial;
  std::vector<NumberedProfile> fitted; // the profiles that the tables belong to, in order
};

TableUse table_use(const Graph& graph, const PassTypeRegistry& pass_types);
// Fits the used tables: up to 0.2 s for the pyramids and 0.1 s per profile for separable. Copies
// tables of profiles that `before` has, too. Thread: any.
KernelTables make_kernel_tables(const TableUse& use, std::span<const NumberedProfile> profiles,
                                const KernelTables* before = nullptr);

} // namespace dermis::subsurface
