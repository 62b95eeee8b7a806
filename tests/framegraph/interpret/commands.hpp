#pragma once
// Unrolls a plan over several frames into one list of commands, and generates the orders in which a
// device may run them.

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <vector>

namespace dermis {

// Pieces of memory with separate contents: each mip of each layer of an image, or a buffer, in a
// placement or in a host resource.
struct MemoryPieces {
  std::vector<uint32_t> first; // By resource: the index of its first piece.
  // By piece: all pieces with a common byte, including itself.
  std::vector<std::vector<uint32_t>> overlap;

  // Returns the pieces of one instance in the range: by mip, then by layer.
  std::vector<uint32_t> pieces(const Plan& plan, uint32_t resource, uint32_t frames_back,
                               uint32_t frame, const SubresourceRange& range) const;
};

// `plan` must pass verify_structure().
MemoryPieces memory_of(const Plan& plan);

inline constexpr uint32_t no_wait = 0xffffffffu;

struct Command {
  uint32_t frame = 0;
  bool is_pass = false;
  uint32_t index = 0; // Index into Plan::passes or Plan::barriers.
  uint32_t batch = 0; // Barriers of one batch have the same number and do not wait for each other.
  Queue queue = Queue::main;
  uint32_t wait_until = no_wait; // A wait: for all commands of the other queue up to this index.
};

// Returns all commands of the frames first .. end - 1, in recorded order.
std::vector<Command> record(const Plan& plan, uint32_t first, uint32_t end);

// Returns an order of `commands`, as indices, that execution dependencies allow; seed 0 is the
// recorded order.
// - A barrier waits for earlier accesses and barriers in its source scope on memory that overlaps
//   its own. Later accesses in its destination scope on such memory wait for the barrier.
// - An acquire from the host waits for the release to the host in the previous frame.
// - A wait waits for commands of the other queue; all later commands of its own queue wait for it.
// - Nothing else waits.
std::vector<uint32_t> legal_order(const Plan& plan, const MemoryPieces& memory,
                                  const std::vector<Command>& commands, uint64_t seed);

} // namespace dermis
