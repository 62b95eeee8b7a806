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
    if (use.bind_error != Use::BindError::none) continue;
    const ResourceInfo& info = c.info[use.resource.value];
    if (info.host_owned || info.history || info.parts > 1) return use.resource;
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
    c.record_reason(Reason::About::pass, pass,
                    tie.valid() ? Reason::ReasonKind::not_beside : Reason::ReasonKind::beside, tie.value);
  }
}

void keep_orderings(CompileContext& c) {
  if (!c.ordered) return;
  Plan& plan = c.out->plan;
  std::vector<uint32_t> position_of(c.graph->passes.size(), no_value);
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    position_of[plan.passes[position].declared.value] = position;
  for (uint32_t later = 0; later < plan.passes.size(); ++later) {
    const uint32_t pass = plan.passes[later].declared.value;
    const std::vector<Ordering>& after = c.graph->passes[pass].after;
    for (uint32_t i = 0; i < after.size(); ++i) {
      const uint32_t earlier = position_of[after[i].after.value];
      if (earlier == no_value) continue; // does not run
      plan.orderings.push_back({earlier, later});
      c.record_reason(Reason::About::pass, pass, Reason::ReasonKind::behind, after[i].after.value, i);
      if (plan.passes[earlier].queue != plan.passes[later].queue)
        c.needs_point[later] = std::max(c.needs_point[later], earlier + 2);
    }
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

void find_round_trips(CompileContext& c) {
  const Plan& plan = c.out->plan;
  const auto index = [](Queue queue) { return static_cast<size_t>(queue); };
  const size_t count = plan.passes.size();
  // Of each queue: how many positions, counted through three frames, hold passes of that queue which are
  // done.
  using Done = std::array<size_t, 2>;
  struct Point {
    size_t behind = 0; // positions, up to the pass that reaches it
    Done done{};       // known to its queue by then
  };
  std::array<Done, 2> known{};                 // by queue that knows it
  std::array<std::vector<Point>, 2> reached{}; // of this frame
  std::array<Point, 2> last{};                 // of the frame before
  c.round_trip.assign(count, {});
  for (const size_t begin : {size_t{0}, count, 2 * count}) {
    const auto wait = [&](Queue queue, uint32_t point) {
      if (point == no_point) return;
      const size_t own = index(queue), other = 1 - own;
      const Point& at = point == 0 ? last[other] : reached[other][point - 1];
      known[own][other] = std::max(known[own][other], at.behind);
      known[own][own] = std::max(known[own][own], at.done[own]);
    };
    for (size_t position = 0; position < count; ++position) {
      const PlanPass& pass = plan.passes[position];
      const size_t own = index(pass.queue);
      wait(pass.queue, pass.wait);
      for (size_t back = 0; back < c.round_trip[position].size(); ++back) { // the third frame's stay
        const size_t first = begin - std::min(begin, back * count), done = known[own][own];
        c.round_trip[position][back] = static_cast<uint32_t>(std::min(done - std::min(done, first), count));
      }
      if (pass.signal != 0) reached[own].push_back({begin + position + 1, known[own]});
    }
    wait(Queue::main, plan.final_wait);
    for (size_t q = 0; q < reached.size(); ++q) {
      if (!reached[q].empty()) last[q] = reached[q].back();
      reached[q].clear();
    }
  }
}

} // namespace dermis
