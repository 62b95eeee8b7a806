#pragma once
// Memory that several plans of one graph share, because only one of them runs in a frame.

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace dermis {

enum class HistoryMemory : uint8_t {
  shared,   // with other plans, where no frame needs both
  separate, // blocks that plans share hold only transients
};

inline constexpr uint32_t no_block = 0xffffffffu;

// Returns the alignment in bytes of a plan's heap.
using HeapAlignment = std::function<uint64_t(const Plan& plan, uint32_t heap)>;

struct SharedBlock {
  uint32_t memory_type_bits = 0;
  uint64_t bytes = 0, alignment = 1;
  bool history = false; // contents last from frame to frame
};

// Place of a plan's heap; no_block: the heap has memory of its own.
struct SharedPlace {
  uint32_t block = no_block;
  uint64_t offset = 0;
};

struct SharedHeaps {
  std::vector<SharedBlock> blocks;
  std::vector<std::vector<SharedPlace>> places; // by plan, then by heap of the plan
  // Sizes of all heaps together, shared or not.
  uint64_t transient_bytes = 0, history_bytes = 0;
};

// Places heaps of plans into blocks, one for each set of memory types. Within a block the heaps of
// one plan follow each other, and those of different plans overlap. Heaps of transients are always
// shared. A heap of histories is shared if no other plan has one of its histories: frames of other
// plans make such histories invalid, so their contents need not last. Histories that two plans have
// are copied from one to the other. Histories are only shared if this takes less memory. A single
// plan shares nothing.
// The plans come from one graph, so that they name resources alike.
// alignment_of: alignment that a device needs; empty: as the plans say.
SharedHeaps share_heaps(std::span<const Plan* const> plans, HistoryMemory histories,
                        const HeapAlignment& alignment_of = {});

} // namespace dermis
