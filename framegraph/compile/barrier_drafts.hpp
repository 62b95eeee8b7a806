#pragma once
// Barriers in the order in which the walk finds them, before they are sorted into batches. Internal
// to compile/.

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/queue_sync.hpp"

#include <vector>

namespace dermis {

struct BarrierDrafts {
  // A barrier of a divided image, which is placed after all accesses of its pass are known.
  struct Deferred {
    uint32_t draft = 0;
    uint32_t predecessor = invalid_index; // position of the pass that it waits for
  };

  std::vector<PlanBarrier> barriers;
  // By draft: position of the pass before which the barrier is recorded (after it, for releases);
  // invalid_index: dropped. write_to_plan replaces it by the index in Plan::barriers.
  std::vector<uint32_t> batch_of;
  uint32_t last_batch = invalid_index; // position of its pass
  size_t first_reason = 0;             // of this phase, in Report::reasons
  bool two_queues = false;
  std::vector<Deferred> deferred;
  std::vector<uint32_t> latest_predecessor; // by plan resource: memory of place_deferred
  std::vector<uint32_t> batch_filled;       // memory of write_to_plan: two counts for each pass

  // `resources`: plan resources if some image is divided, else 0.
  void begin(bool two, size_t resources);

  uint32_t add() {
    const auto index = static_cast<uint32_t>(batch_of.size());
    barriers.emplace_back();
    batch_of.push_back(invalid_index);
    return index;
  }

  // Places a barrier into a batch between the passes at `predecessor` and at `position`: into the
  // last batch if that lies between them, else into a new batch before `position`.
  void place(uint32_t draft, uint32_t predecessor, uint32_t position) {
    if (two_queues) { // passes in between may be the other queue's
      batch_of[draft] = position;
      return;
    }
    const bool shares =
        last_batch != invalid_index && (predecessor == invalid_index || predecessor < last_batch);
    if (!shares) last_batch = position;
    batch_of[draft] = last_batch;
  }

  // Places the deferred barriers of one image into one batch, so that they can be merged.
  void place_deferred(uint32_t position);

  // Drops barriers that change no layout and wait only for passes that the waits between queues
  // cover: passes that ran on the other queue, or that the other queue waited for before this queue
  // waited for it.
  void drop_covered(const QueueSync& queues, Report& report);

  // Merges barriers of one batch that differ only in their subresource range, and their reasons.
  void merge_ranges(Report& report);

  // Sorts the drafts into batches and gives the batches to the passes. Drafts of one batch keep
  // their order.
  void write_to_plan(bool in_order, Report& report, Plan& plan);
};

} // namespace dermis
