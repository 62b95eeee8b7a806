#pragma once
// The verifier's model. A *thing* is a piece of memory with one layout: a part of an image that no access and
// no barrier divides, or a buffer, in a placement or in what the host bound to a slot. Parts of one image
// share no byte; images and buffers whose placements overlap share those that the placements share. Every
// access leaves an *event* on its thing, which remembers at which stages later work is ordered behind it and
// where a write is visible. Barriers extend both along execution chains (Vulkan 1.3, "Execution and Memory
// Dependencies"), on the bytes of their own thing alone. memory.hpp keeps the events by the bytes they are
// on.
//
//  read    Every earlier write to the same bytes is ordered before it, the last one to the same thing is
//          visible to it, and the contents are defined and are those of the frame meant: written that many
//          frames ago, or before the first.
//  write   Goes to this frame's instance. Every earlier access to the same bytes is ordered before it, every
//  earlier write is available, and
//          the last one visible to it unless it was read since: then the wait for the reader is enough.
//  maybe   A read that depends on the validity of a history counts as if it happened, but nobody may
//          rely on it.
//  both    What a pass writes it touches in no other way, except to read the same thing texel by texel
//          (PlanAccess::own_texels). An access that reads and writes counts as one.
//  layout  Equals what the access was planned with; transitions are writes; `undefined` discards.
//  queues  A barrier orders what is on its own queue. A wait for a point orders and shows to its queue
//          all that the other one had done, or had been ordered behind, when it reached the point. What
//          one queue left the other one touches once released and acquired, or discards.
//  host    A slot is taken over before its first access and handed back, ordered and available, at the
//          end.

#include "framegraph/compile/plan.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace dermis {

inline constexpr size_t queues = 2;
inline constexpr uint64_t everything = ~uint64_t{0}; // stages or accesses: behind a semaphore
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
  Stage stages = 0;  // where it happened; 0 for a layout transition, which only chains
  Access writes = 0; // 0: a read
  bool is_write = false;
  bool certain = true; // false: a read that some frames leave out
  Queue queue = Queue::main;
  int64_t at = 0;                                  // which pass it was, counted through all frames
  const PlanAccess* access = nullptr;              // and which of its accesses; none: a layout transition
  std::array<Stage, queues> ordered{};             // by queue: later work at these stages happens after it
  std::array<int64_t, queues> since{never, never}; // by queue: the pass from which on that is so
  bool available = false;
  std::vector<Visible> visible;

  bool operator==(const Event&) const = default;
};

struct Subresource {
  uint32_t owner = 0;               // into Memory::instances
  uint32_t placement = no_instance; // or the host's
  bool image = false;
  bool with_host = false;    // not ours to touch now
  bool handed_back = false;  // to the host, in this frame
  Queue queue = Queue::main; // whose it is
  bool in_transfer = false;  // released by that queue
  Layout released_old = Layout::undefined, released_new = Layout::undefined;
  bool defined = false; // contents mean something
  int64_t of_frame = 0; // what was written last: below 0 as the executor made it
  Layout layout = Layout::undefined;
  bool written = false; // since other instances left something on its bytes
};

// One instance of a resource: its parts follow each other among the things.
struct InstanceSubresources {
  uint32_t first = 0, count = 0;
  uint32_t used_subresources = 0;       // that the plan ever touches
  uint32_t written_subresources = 0;    // see Thing::written
  uint32_t space = 0;                   // its heap, or what the host bound
  uint64_t begin = 0, end = UINT64_MAX; // bytes there
};

} // namespace dermis
