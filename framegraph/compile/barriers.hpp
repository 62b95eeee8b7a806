#pragma once
// The barrier phase: accesses of each pass, barriers in batches, waits between queues. Start
// reading in barriers.cpp. Internal to compile/.

#include "framegraph/compile/barrier_drafts.hpp"
#include "framegraph/compile/queue_sync.hpp"
#include "framegraph/compile/sync_objects.hpp"
#include "framegraph/compile/usage_sets.hpp"

#include <vector>

namespace dermis {

struct PassAccess { // all accesses of one pass to one object
  uint32_t object = 0, resource = 0, frames_back = 0;
  uint16_t usages = 0; // mask of 1 << usage
  bool always = false; // in every frame
  uint32_t range = 0;  // of the resource
  Layout layout = Layout::undefined;
  bool internally_ordered = false; // also reads what it writes
};

struct PassAccesses {
  std::vector<PassAccess> list;      // the first `count` belong to the current pass
  std::vector<uint32_t> of_use;      // by use of the current pass: into list, or invalid_index
  std::vector<uint32_t> last_number; // by object: of its last access, counted through all passes
  uint32_t first_number = 1;         // of the current pass
  uint32_t count = 0;

  void begin(size_t objects) {
    last_number.assign(objects, 0);
    first_number = 1;
    count = 0;
  }
};

struct HeapRange { // bytes and their last occupant in this frame; the ranges of a heap have no gaps
  uint64_t begin = 0, end = 0;
  uint32_t resource = invalid_index; // plan resource; invalid_index: no occupant yet
  uint32_t frames_back = 0;          // of a history
};

struct FirstUse { // a first use of bytes that had no occupant before in this frame
  uint64_t begin = 0, end = 0;
  uint32_t memory = 0, barrier = 0, resource = 0;
};

struct DividedFirstUse { // the first use of one range of a divided image
  uint32_t barrier = 0, resource = 0, object = 0;
};

struct MemoryLocation {
  uint32_t memory = 0; // into MemoryOccupancy::ranges
  uint64_t begin = 0, end = 0;
};

struct MemoryOccupancy {
  // One list for each heap, then two for each history with aliases: its idle memory before this
  // frame's contents are first accessed, and after the last read of the oldest frame. The instance
  // of the latter is that of the former in the next frame.
  std::vector<std::vector<HeapRange>> ranges;
  std::vector<MemoryLocation> location; // by plan resource
  std::vector<uint32_t>
      idle_memory; // by plan resource: into ranges, if it is the target of aliases
  std::vector<uint32_t>
      first_barrier; // by plan resource: draft of the first use, except host and histories
  std::vector<uint32_t>
      predecessor; // by plan resource, if images are divided: last pass that had the bytes
  std::vector<FirstUse> first_uses;
  std::vector<DividedFirstUse> divided_first_uses;
};

struct BarrierScratch {
  SyncObjects objects;
  PassAccesses accesses;
  BarrierDrafts drafts;
  QueueSync queues;
  MemoryOccupancy memory;
};
// Fills accesses, barriers, waits between queues, and histories of the plan.
void emit_barriers(const CompileInput& in, const Activation& active,
                   const Subresources& subresources, const Versions& versions,
                   const QueueAssignment& queues, const ResourceMemory& memory,
                   const Histories& histories, const Placements& placements, Report& report,
                   Plan& plan, BarrierScratch& scratch);

} // namespace dermis
