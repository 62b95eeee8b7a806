#pragma once
// A plan over several frames as one list of commands, and the orders in which a device may run them.

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <vector>

namespace dermis {

// A piece of memory with contents of its own: one mip of one layer of an image, or a buffer, in a placement
// or in what the host binds to a resource.
struct Memory {
  std::vector<uint32_t> first;                // by resource: number of its first piece
  std::vector<std::vector<uint32_t>> overlap; // by piece: pieces with a byte in common, itself included

  // The pieces of one instance in the range: mips first, each by layers.
  std::vector<uint32_t> pieces(const Plan& plan, uint32_t resource, uint32_t frames_back, uint32_t frame,
                               const SubresourceRange& range) const;
};

// `plan` must pass verify_structure().
Memory memory_of(const Plan& plan);

inline constexpr uint32_t no_wait = 0xffffffffu;

struct Command {
  uint32_t frame = 0;
  bool is_pass = false;
  uint32_t index = 0; // into Plan::passes or Plan::barriers
  uint32_t batch = 0; // barriers of one batch have the same number and do not wait for each other
  Queue queue = Queue::main;
  uint32_t wait_until = no_wait; // a wait: for all commands of the other queue up to this one
};

// All commands of the frames first .. end - 1, in the order in which they are recorded.
std::vector<Command> record(const Plan& plan, uint32_t first, uint32_t end);

// An order of `commands`, as indices into it, that execution dependencies allow and `seed` picks; seed 0: as
// recorded. A barrier waits for accesses and barriers before it, in its source scope, on memory that overlaps
// its own; accesses after it, in its destination scope, on such memory wait for it. What the host gives for
// one frame waits for what it was given back in the frame before. A wait waits for commands of the other
// queue, and all later ones of its own for it. Nothing else waits.
std::vector<uint32_t> legal_order(const Plan& plan, const Memory& memory,
                                  const std::vector<Command>& commands, uint64_t seed);

} // namespace dermis
