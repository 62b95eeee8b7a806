// Which passes run on the async queue, and at which points the queues wait for each other.

#include "framegraph/compile/barriers/steps.hpp"

#include <algorithm>
#include <array>

namespace dermis {
namespace {

// A resource that keeps a pass on the main queue, or none: the host's, since the host hands it to one queue;
// histories, whose frames would change queues between frames; and images that ports divide.
ResourceId tie_to_main(const CompileContext& c, uint32_t pass) {
  for (uint32_t u = c.first_use[pass]; u < c.first_use[pass + 1]; ++u) {
    const Use& use = c.uses[u];
    if (use.trouble != Use::Trouble::none) continue;
    const ResourceFacts& facts = c.facts[use.resource.value];
    if (facts.host_owned || facts.history || facts.parts > 1) return use.resource;
  }
  return {};
}

} // namespace

void choose_queues(CompileContext& c) {
  c.queue.clear();
  if (c.input->single_queue) return;
  c.queue.assign(c.graph->passes.size(), Queue::main);
  for (uint32_t pass = 0; pass < c.queue.size(); ++pass) {
    if (!c.live[pass] || !c.graph->passes[pass].async) continue;
    const ResourceId tie = tie_to_main(c, pass);
    if (!tie.valid()) c.queue[pass] = Queue::async;
    c.because(Reason::About::pass, pass, tie.valid() ? Reason::Why::not_beside : Reason::Why::beside,
              tie.value);
  }
}

void number_points(CompileContext& c) {
  Plan& plan = c.out->plan;
  const auto index = [](Queue queue) { return static_cast<size_t>(queue); };
  // As needs_point counts, by queue: who has waited for a pass has waited for all before it, and for the
  // frame before.
  std::array<uint32_t, 2> waited{0, 0};
  uint32_t last_of_main = 0, last_of_async = 0; // what the next frame waits for
  std::vector<uint8_t> awaited(plan.passes.size(), 0);
  std::vector<uint32_t> seen(plan.passes.size(), 0); // by position: how much of the other queue, likewise
  std::array<uint32_t, 2> returned{0, 0};
  c.round_trip.assign(plan.passes.size(), 0);
  uint32_t awaited_by_async = 0; // of the main queue, in the whole frame
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    if (plan.passes[position].queue == Queue::async)
      awaited_by_async = std::max(awaited_by_async, c.needs_point[position]);
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    const Queue queue = plan.passes[position].queue;
    uint32_t& need = c.needs_point[position];
    uint32_t& before = waited[index(queue)];
    // Nobody of this frame was waited for yet, who comes after the frame before.
    const bool frame_before = c.needs_frame_before[position] != 0 && std::max(need, before) <= 1;
    // In the frame before, the async queue has waited for part of it already.
    if (frame_before && queue == Queue::async && c.needs_frame_before[position] > awaited_by_async) {
      need = 1;
      last_of_main = std::max(last_of_main, c.needs_frame_before[position]);
    }
    if (frame_before && queue == Queue::main)
      last_of_async = std::max(last_of_async, c.needs_frame_before[position]);
    if (need <= before) need = 0;
    before = std::max(before, need);
    if (need >= 2) awaited[need - 2] = 1;
    if (before < 2) continue;
    seen[position] = before - 1;
    returned[index(queue)] = std::max(returned[index(queue)], seen[before - 2]);
    c.round_trip[position] = returned[index(queue)];
  }
  if (last_of_async <= waited[index(Queue::main)]) last_of_async = 0;
  if (last_of_async >= 2) awaited[last_of_async - 2] = 1;
  // The frame after waits for the last point of this one, wherever that is.
  bool reached = last_of_main == 0;
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    reached |=
        awaited[position] && plan.passes[position].queue == Queue::main && position + 2 >= last_of_main;
  if (!reached) awaited[last_of_main - 2] = 1;

  std::array<uint32_t, 2> points{0, 0};
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    PlanPass& pass = plan.passes[position];
    const uint32_t need = c.needs_point[position];
    if (need == 1) pass.wait = 0;
    if (need >= 2) pass.wait = plan.passes[need - 2].signal; // which stands before it
    if (awaited[position]) pass.signal = ++points[index(pass.queue)];
  }
  if (last_of_async >= 2) plan.final_wait = plan.passes[last_of_async - 2].signal;
}

} // namespace dermis
