#include "tests/framegraph/hazard_operation.hpp"

#include <algorithm>
#include <utility>

namespace dermis::testing {
namespace {

struct Unroller {
  const Plan& plan;
  std::vector<Operation> all = {};
  std::string misplaced = {};

  void add(Operation operation, const SubresourceRange& range) {
    if (is_host_resource(plan, operation.resource)) {
      operation.heap = ~(uint64_t{operation.resource} << 32 | operation.instance);
    } else {
      const Placement& at =
          plan.placements[plan.resources[operation.resource].first_instance + operation.instance];
      operation.heap = at.heap;
      operation.begin = at.offset;
      operation.end = at.offset + at.size;
    }
    for (uint32_t m = range.first_mip; m < uint32_t{range.first_mip} + range.mips; ++m)
      for (uint32_t l = range.first_layer; l < uint32_t{range.first_layer} + range.layers; ++l) {
        operation.mip = m;
        operation.layer = l;
        all.push_back(operation);
      }
  }

  // `step_of` holds the steps of the earlier passes of this frame.
  bool follows(const PlanOrdering& ordering, const std::vector<uint32_t>& step_of) const {
    if (ordering.earlier >= step_of.size()) return false;
    const Queue queue = plan.passes[ordering.later].queue;
    return plan.passes[ordering.earlier].queue == queue ||
           std::any_of(all.begin(), all.end(), [&](const Operation& o) {
             return o.what == Operation::What::wait && o.queue == queue &&
                    o.until >= step_of[ordering.earlier];
           });
  }

  void unroll(uint32_t frames) {
    uint32_t step = 0;
    std::vector<uint32_t> reached[2]; // Steps, by queue and timeline point.
    for (uint32_t f = 0; f < frames; ++f) {
      const size_t before[2] = {reached[0].size(), reached[1].size()};
      const auto barriers = [&](uint32_t first, uint32_t count, Queue queue, bool releases) {
        for (uint32_t b = first; b < first + count; ++b) {
          const PlanBarrier& one = plan.barriers[b];
          if ((one.transfer == PlanBarrier::Transfer::release) != releases)
            misplaced = "a release is in the wrong place";
          Operation operation{Operation::What::barrier,
                              step++,
                              f,
                              one.resource,
                              instance_in_frame(plan, one.resource, one.frames_back, f),
                              nullptr,
                              &one};
          operation.queue = queue;
          add(operation, one.range);
        }
      };
      const auto wait = [&](uint32_t point, Queue queue) {
        if (point == no_point) return;
        const size_t other = 1 - queue_index(queue);
        const size_t awaited = before[other] + point;
        if (awaited > reached[other].size())
          misplaced = "a point is waited for that is not reached";
        if (awaited == 0 || awaited > reached[other].size()) return;
        Operation operation{Operation::What::wait, step++, f, no_instance, 0, nullptr, nullptr};
        operation.queue = queue;
        operation.until = reached[other][awaited - 1];
        all.push_back(operation);
      };
      const auto reach = [&](uint32_t point, Queue queue) {
        if (point == 0) return;
        if (before[queue_index(queue)] + point != reached[queue_index(queue)].size() + 1)
          misplaced = "a point is reached out of turn";
        reached[queue_index(queue)].push_back(step++);
      };
      for (uint32_t r = 0; r < plan.resources.size(); ++r)
        add({Operation::What::frame_begins, step++, f, r, instance_in_frame(plan, r, 0, f), nullptr,
             nullptr},
            plan.resources[r].whole());
      std::vector<uint32_t> step_of; // Indexed by pass.
      for (const PlanPass& pass : plan.passes) {
        wait(pass.wait, pass.queue);
        for (const PlanOrdering& ordering : plan.orderings)
          if (&plan.passes[ordering.later] == &pass && !follows(ordering, step_of))
            misplaced = "a pass does not come after one that it is to follow";
        barriers(pass.first_barrier, pass.barrier_count, pass.queue, false);
        for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
          const PlanAccess& one = plan.accesses[a];
          Operation operation{Operation::What::access,
                              step,
                              f,
                              one.resource,
                              instance_in_frame(plan, one.resource, one.frames_back, f),
                              &one,
                              nullptr};
          operation.queue = pass.queue;
          add(operation, one.range);
        }
        step_of.push_back(step);
        ++step;
        barriers(pass.first_barrier + pass.barrier_count, pass.release_count, pass.queue, true);
        reach(pass.signal, pass.queue);
      }
      wait(plan.final_wait, Queue::main);
      barriers(plan.first_final_barrier, plan.final_barrier_count, Queue::main, false);
    }
  }
};

} // namespace

UnrolledPlan unroll(const Plan& plan, uint32_t frames) {
  Unroller unroller{plan};
  unroller.unroll(frames);
  return {std::move(unroller.all), std::move(unroller.misplaced)};
}

} // namespace dermis::testing
