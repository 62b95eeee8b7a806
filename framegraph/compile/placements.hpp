#pragma once
// The placement phase: heaps and offsets of all resource instances. Internal to compile/.

#include "framegraph/compile/packer.hpp"
#include "framegraph/compile/values.hpp"

#include <vector>

namespace dermis {

struct MemoryGroup { // instances that may share a heap
  bool persistent = false;
  uint32_t type_bits = 0; // memory types that all instances allow
  uint32_t buffers = 0, images = 0;
};

struct PlacementScratch {
  Placements result;
  std::vector<MemoryGroup> groups;      // by heap
  std::vector<PackItem> items;          // of the group that is placed
  std::vector<uint32_t> item_placement; // by item: into Plan::placements
  Packer packer;
  Packing packing;
};
// Gives every resource a location in memory: fills Plan::heaps and Plan::placements.
const Placements& place_resources(const CompileInput& in, const Sizes& sizes,
                                  const Subresources& subresources, const QueueAssignment& queues,
                                  const ResourceMemory& memory, const Schedule& schedule,
                                  const Histories& histories, Report& report, Plan& plan,
                                  PlacementScratch& scratch);

struct AliasInput {
  const CompileInput& in;
  const Subresources& subresources;
  const ResourceMemory& memory;
  const Schedule& schedule;
  const Histories& histories;
  const Plan& plan; // placed without history aliases
  const std::vector<MemoryGroup>& groups;
};
// Chooses transients that move into idle history memory; `aliases` is by plan resource. False:
// none.
bool find_history_aliases(const AliasInput& input, std::vector<HistoryAlias>& aliases);

} // namespace dermis
