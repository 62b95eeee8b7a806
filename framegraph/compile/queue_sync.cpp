#include "framegraph/compile/queue_sync.hpp"

#include <algorithm>

namespace dermis {
namespace {

size_t queue_index(Queue queue) {
  return static_cast<size_t>(queue);
}

} // namespace

void QueueSync::begin(bool two, size_t objects, size_t passes) {
  two_queues = two;
  waits.assign(two ? passes : 0, 0);
  waits_frame_before.assign(two ? passes : 0, 0);
  last_access.assign(two ? objects : 0, {});
  last_access_at_frame_end.clear();
  draft_waits.clear();
  round_trips.clear();
}

void QueueSync::wait_on_own_queue(uint32_t draft, const QueueSyncPoint& access) {
  if (!two_queues) return;
  FrameCounts& ends = draft_wait(draft).ends;
  const size_t oldest =
      ends.size() - 1; // a wait for any pass of the oldest frame includes everything older
  if (access.frames_back > oldest)
    ends[oldest] = std::max(ends[oldest], 1u);
  else
    ends[access.frames_back] = std::max(ends[access.frames_back], access.end);
}

void QueueSync::add_orderings(const Graph& graph, const Activation& active, Report& report,
                              Plan& plan) {
  if (!active.ordered) return;
  std::vector<uint32_t> position_of(graph.passes.size(), invalid_index);
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    position_of[plan.passes[position].declared.value] = position;
  for (uint32_t later = 0; later < plan.passes.size(); ++later) {
    const uint32_t pass = plan.passes[later].declared.value;
    const std::vector<Ordering>& after = graph.passes[pass].after;
    for (uint32_t i = 0; i < after.size(); ++i) {
      const uint32_t earlier = position_of[after[i].after.value];
      if (earlier == invalid_index) continue; // does not run
      plan.orderings.push_back({earlier, later});
      report.record_reason(Reason::About::pass, pass, Reason::ReasonKind::after_pass,
                           after[i].after.value, i);
      if (plan.passes[earlier].queue != plan.passes[later].queue) wait_for_pass(later, earlier);
    }
  }
}

void QueueSync::assign_points(Plan& plan) {
  // By queue, encoded as in `waits`: the last pass that the queue has waited for so far. That wait
  // includes all earlier passes and the previous frame.
  std::array<uint32_t, 2> waited{0, 0};
  uint32_t last_of_main = 0, last_of_async = 0; // that the next frame waits for
  std::vector<uint8_t> awaited(plan.passes.size(), 0);
  uint32_t awaited_by_async =
      0; // last pass of the main queue that the async queue waits for in a frame
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    if (plan.passes[position].queue == Queue::async)
      awaited_by_async = std::max(awaited_by_async, waits[position]);
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    const Queue queue = plan.passes[position].queue;
    uint32_t& wait = waits[position];
    uint32_t& before = waited[queue_index(queue)];
    // No wait in this frame implies the previous frame yet.
    const bool frame_before = waits_frame_before[position] != 0 && std::max(wait, before) <= 1;
    // In the previous frame, the async queue has waited for the passes up to awaited_by_async.
    if (frame_before && queue == Queue::async && waits_frame_before[position] > awaited_by_async) {
      wait = 1;
      last_of_main = std::max(last_of_main, waits_frame_before[position]);
    }
    if (frame_before && queue == Queue::main)
      last_of_async = std::max(last_of_async, waits_frame_before[position]);
    if (wait <= before) wait = 0;
    before = std::max(before, wait);
    if (wait >= 2) awaited[wait - 2] = 1;
  }
  if (last_of_async <= waited[queue_index(Queue::main)]) last_of_async = 0;
  if (last_of_async >= 2) awaited[last_of_async - 2] = 1;
  // The next frame waits for the last point of this frame, whichever pass signals it.
  bool reached = last_of_main == 0;
  for (uint32_t position = 0; position < plan.passes.size(); ++position)
    reached |= awaited[position] && plan.passes[position].queue == Queue::main &&
               position + 2 >= last_of_main;
  if (!reached) awaited[last_of_main - 2] = 1;

  std::array<uint32_t, 2> points{0, 0};
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    PlanPass& pass = plan.passes[position];
    const uint32_t wait = waits[position];
    if (wait == 1) pass.wait = 0;
    if (wait >= 2) pass.wait = plan.passes[wait - 2].signal; // set already: that pass is earlier
    if (awaited[position]) pass.signal = ++points[queue_index(pass.queue)];
  }
  if (last_of_async >= 2) plan.final_wait = plan.passes[last_of_async - 2].signal;
}

void QueueSync::find_round_trips(const Plan& plan) {
  const size_t count = plan.passes.size();
  // By queue: number of positions, counted through three frames, whose passes on that queue are
  // complete.
  using Complete = std::array<size_t, 2>;
  struct Point {
    size_t end = 0;      // positions up to and including the pass that signals the point
    Complete complete{}; // known to the signalling queue at that point
  };
  std::array<Complete, 2> known{};               // by queue that knows
  std::array<std::vector<Point>, 2> signalled{}; // in this frame
  std::array<Point, 2> last{};                   // of the previous frame
  round_trips.assign(count, {});
  for (const size_t begin : {size_t{0}, count, 2 * count}) {
    const auto wait = [&](Queue queue, uint32_t point) {
      if (point == no_point) return;
      const size_t own = queue_index(queue), other = 1 - own;
      const Point& at = point == 0 ? last[other] : signalled[other][point - 1];
      known[own][other] = std::max(known[own][other], at.end);
      known[own][own] = std::max(known[own][own], at.complete[own]);
    };
    for (size_t position = 0; position < count; ++position) {
      const PlanPass& pass = plan.passes[position];
      const size_t own = queue_index(pass.queue);
      wait(pass.queue, pass.wait);
      for (size_t back = 0; back < round_trips[position].size();
           ++back) { // the third frame's values remain
        const size_t first = begin - std::min(begin, back * count), complete = known[own][own];
        round_trips[position][back] =
            static_cast<uint32_t>(std::min(complete - std::min(complete, first), count));
      }
      if (pass.signal != 0) signalled[own].push_back({begin + position + 1, known[own]});
    }
    wait(Queue::main, plan.final_wait);
    for (size_t q = 0; q < signalled.size(); ++q) {
      if (!signalled[q].empty()) last[q] = signalled[q].back();
      signalled[q].clear();
    }
  }
}

} // namespace dermis
