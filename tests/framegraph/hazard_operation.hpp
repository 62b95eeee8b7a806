#pragma once
// The commands of a plan as the hazard oracle sees them, one subresource at a time.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <vector>

namespace dermis::testing {

// The effect of one command on one subresource: one mip of one layer of one resource instance.
struct Operation {
  enum class What { access, barrier, frame_begins, wait } what = What::access;
  // Passes and barriers, counted through all frames; the accesses of a pass have one step.
  uint32_t step = 0;
  uint32_t frame = 0;
  uint32_t resource = 0, instance = 0;
  const PlanAccess* access = nullptr;
  const PlanBarrier* barrier = nullptr;
  uint32_t mip = 0, layer = 0;
  Queue queue = Queue::main;
  uint32_t until = 0; // For a wait: the last step of the other queue that has finished by then.
  // The memory of the instance. Each host resource has its own heap.
  uint64_t heap = 0, begin = 0, end = 1;
};

inline bool same_instance(const Operation& a, const Operation& b) {
  return a.resource == b.resource && a.instance == b.instance;
}
inline bool same_subresource(const Operation& a, const Operation& b) {
  return same_instance(a, b) && a.mip == b.mip && a.layer == b.layer;
}
inline bool is_barrier(const Operation& o) {
  return o.what == Operation::What::barrier;
}
inline bool accesses(const Operation& o) {
  return o.what == Operation::What::access;
}
inline Access written(const Operation& o) {
  return accesses(o) ? o.access->access & all_write_access : 0;
}
// An internally ordered access reads only what its own pass writes.
inline Access read(const Operation& o) {
  return accesses(o) && !o.access->internally_ordered ? o.access->access & ~all_write_access : 0;
}

inline size_t queue_index(Queue queue) {
  return queue == Queue::main ? 0 : 1;
}
inline bool is_host_resource(const Plan& plan, uint32_t resource) {
  return plan.resources[resource].first_instance == no_instance;
}
inline uint32_t instance_in_frame(const Plan& plan, uint32_t resource, uint32_t frames_back,
                                  uint32_t frame) {
  const uint32_t count = plan.resources[resource].instance_count;
  return (frame + count - frames_back) % count;
}

struct UnrolledPlan {
  std::vector<Operation> operations; // In the order of recording.
  std::string misplaced;             // An error in signals, waits, releases or orderings, or "".
};

// Returns the operations of the first frames. Indices of the plan must be in range.
UnrolledPlan unroll(const Plan& plan, uint32_t frames);

} // namespace dermis::testing
