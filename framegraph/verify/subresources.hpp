#pragma once
// Data model of the verifier. A *subresource* is a piece of memory with one layout: a buffer, or a
// part of an image that no access and no barrier divides. It lies in a placement or in a resource
// that the host bound to a slot. Parts of one image share no byte; images and buffers whose
// placements overlap share the overlapping bytes.
//
// Every access leaves an *event* on its subresource. The event remembers which stages of later work
// are ordered after the access, and where a write is visible. Barriers extend both along execution
// chains (Vulkan 1.3, "Execution and Memory Dependencies"), only on the bytes of their own
// subresource. memory.hpp keeps the events by byte range.
//
// Rules:
// - read: Every earlier write to the bytes is ordered before the read, and the last write to the
//   subresource is visible to the read. The contents are defined and belong to the named frame:
//   written that many frames ago, or before the first frame.
// - write: Goes to the instance of the current frame. Every earlier access to the bytes is ordered
//   before the write, and every earlier write is available. The last write is visible to it, unless
//   a read followed that write: then waiting for the reader is enough.
// - conditional read: A read that depends on the validity of a history counts as if it happened,
//   but no other access may rely on it.
// - read and write in one pass: A pass accesses what it writes in no other way, except to read the
//   same texels (PlanAccess::own_texels). An access that reads and writes counts as one access. An
//   access that reads what its own pass writes (PlanAccess::internally_ordered) counts as a write.
// - layout: Equals the layout that the access was planned with. Transitions are writes; `undefined`
//   discards the contents.
// - queues: A barrier orders work on its own queue. A wait for a sync point orders everything that
//   the other queue had done, or had been ordered after, when it reached the point, and makes that
//   work visible. A resource used by one queue can be used by the other after a release and an
//   acquire, or after its contents are discarded.
// - host: A slot is acquired from the host before its first access, and released at the end,
//   ordered and available.

#include "framegraph/compile/plan.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace dermis {

inline constexpr size_t queues = 2;
// stages or accesses: everything after a semaphore wait
inline constexpr uint64_t everything = ~uint64_t{0};
inline constexpr int64_t never = INT64_MAX;

inline size_t index_of(Queue queue) {
  return static_cast<size_t>(queue);
}
inline Queue other_than(Queue queue) {
  return queue == Queue::main ? Queue::async : Queue::main;
}

struct Visible {
  Queue queue;
  Stage stages;
  Access access;

  bool operator==(const Visible&) const = default;
};

struct Event {
  Stage stages = 0;  // stages of the access; 0: a layout transition, which only extends chains
  Access writes = 0; // 0: a read
  bool is_write = false;
  bool certain = true; // false: a read that some frames leave out
  Queue queue = Queue::main;
  int64_t at = 0;                     // number of the pass, counted through all frames
  const PlanAccess* access = nullptr; // the access; null: a layout transition
  // by queue: stages of later work that happens after the event
  std::array<Stage, queues> ordered{};
  // by queue: the first pass that `ordered` holds for
  std::array<int64_t, queues> since{never, never};
  bool available = false;
  // by queue: stages of later work that happens after the write was made available
  std::array<Stage, queues> after_available{};
  std::vector<Visible> visible;

  bool operator==(const Event&) const = default;
};

struct Subresource {
  uint32_t owner = 0;               // into Memory::instances
  uint32_t placement = no_instance; // no_instance: host memory
  bool image = false;
  bool with_host = false;        // true: the host owns it now
  bool returned_to_host = false; // to the host, in this frame
  Queue queue = Queue::main;     // queue that owns it
  bool in_transfer = false;      // released by that queue, not yet acquired
  Layout released_old = Layout::undefined, released_new = Layout::undefined;
  bool defined = false; // true: the contents are defined
  int64_t of_frame = 0; // frame of the last write; below 0: as the executor left it
  Layout layout = Layout::undefined;
  bool written = false; // true: written since other instances left events on its bytes
};

// Subresources of one instance of a resource; they have consecutive indices.
struct InstanceSubresources {
  uint32_t first = 0, count = 0;
  uint32_t used_subresources = 0;       // number that accesses and barriers of the plan use
  uint32_t written_subresources = 0;    // see Subresource::written
  uint32_t space = 0;                   // its heap, or the memory that the host bound
  uint64_t begin = 0, end = UINT64_MAX; // bytes there
};

} // namespace dermis
