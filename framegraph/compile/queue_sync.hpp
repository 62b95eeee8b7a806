#pragma once
// Synchronisation between the main queue and the async queue: which pass waits for which point of
// the other queue, and what those waits imply. All vectors are empty in plans with one queue.
// Internal to compile/.

#include "framegraph/compile/values.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace dermis {

struct QueueSyncPoint {
  uint32_t frames_back = 0;
  uint32_t end = 0; // position + 1 of the pass; 0: none
};

struct LastAccess { // of an object
  QueueSyncPoint any, write;
};

// By frames back, 0 .. 2: number of positions, counted from the first. Through the waits of both
// queues, a wait for a pass includes everything older on the same queue.
using FrameCounts = std::array<uint32_t, 3>;

struct OwnQueueWait { // what a barrier waits for on its own queue
  FrameCounts ends{};
  bool layout_kept = false; // the discarded contents have the new layout already
};

struct QueueSync {
  bool two_queues = false;
  // By position: position + 2 of the last pass of the other queue that the pass waits for, in this
  // frame and in the previous frame. 1: all of the previous frame. 0: none.
  std::vector<uint32_t> waits, waits_frame_before;
  std::vector<LastAccess> last_access, last_access_at_frame_end; // by object
  std::vector<OwnQueueWait> draft_waits;                         // by draft
  // Indexed by position: how many passes of the same queue are complete and visible because of a
  // transitive wait: the other queue waited for them, and later this queue for the other one.
  std::vector<FrameCounts> round_trips;

  void begin(bool two, size_t objects, size_t passes);
  void wait_for_pass(uint32_t position, uint32_t earlier) {
    waits[position] = std::max(waits[position], earlier + 2);
  }
  void wait_for_frame_before(uint32_t position, uint32_t earlier) {
    waits_frame_before[position] = std::max(waits_frame_before[position], earlier + 2);
  }
  OwnQueueWait& draft_wait(uint32_t draft) {
    if (draft >= draft_waits.size()) draft_waits.resize(size_t{draft} + 1);
    return draft_waits[draft];
  }
  // The draft waits for an access of its own queue.
  void wait_on_own_queue(uint32_t draft, const QueueSyncPoint& access);

  // Lists in the plan which passes `after` orders, and waits where the two passes are on different
  // queues.
  void add_orderings(const Graph& graph, const Activation& active, Report& report, Plan& plan);

  // Gives every pass the point that it waits for and the point that it signals: as few as `waits`
  // and `waits_frame_before` allow.
  void assign_points(Plan& plan);

  // Computes round_trips from the points.
  void find_round_trips(const Plan& plan);
};

} // namespace dermis
