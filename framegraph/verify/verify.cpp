// Simulates a plan frame by frame, barrier by barrier and access by access, and checks it against
// the rules in subresources.hpp.

#include "framegraph/verify/verify.hpp"

#include "framegraph/verify/memory.hpp"
#include "framegraph/verify/structure.hpp"
#include "framegraph/verify/subresource_ranges.hpp"
#include "framegraph/verify/subresources.hpp"
#include "framegraph/verify/within_pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dermis {
namespace {

// Work limits: a hostile plan could divide images without end and place everything in the same
// memory. A chain of 4,096 passes, the longest that a graph may have, takes 3e5 units of work.
constexpr uint64_t max_subresources = 1u << 20, max_work = 1u << 27;

// Waits of one queue for the other queue, in order. Only waits that imply more than the waits
// before them are kept.
struct Waits {
  std::vector<int64_t> until; // last pass of the other queue that is done after the wait
  std::vector<int64_t> at;    // pass that waits

  void add(int64_t pass, int64_t now) {
    if (!until.empty() && until.back() >= pass) return;
    until.push_back(pass);
    at.push_back(now);
  }
  bool knows(int64_t pass) const { return !until.empty() && until.back() >= pass; }
  // Returns the first pass that is ordered after `pass`.
  int64_t since(int64_t pass) const {
    return at[static_cast<size_t>(std::lower_bound(until.begin(), until.end(), pass) -
                                  until.begin())];
  }
};

struct Machine {
  const Plan& plan;
  const std::vector<SubresourceGrid> grids; // by resource
  Memory memory = Memory(plan);
  std::vector<uint32_t> first_instance = {}; // by resource: into Memory::instances
  std::vector<uint8_t> in_place = {};        // by resource: 1: the frame overwrites the oldest one
  std::vector<std::string> violations = {};
  uint32_t frame = 0;
  Queue queue = Queue::main; // queue of the current pass
  int64_t now = 0;           // current pass, counted through all frames
  // by queue and sync point: the pass that reached it
  std::array<std::vector<int64_t>, queues> reached = {};
  std::array<size_t, queues> points_before = {}; // by queue: number of points in earlier frames
  std::array<Waits, queues> waits = {};          // by queue that waits
  int64_t frame_began = 0;                       // last pass before the frame
  uint64_t work_done = 0;                        // work done so far: visits of events

  void prepare() {
    const std::vector<uint32_t> used = used_subresource_counts(plan, grids);
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      const PlanResource& resource = plan.resources[r];
      first_instance.push_back(static_cast<uint32_t>(memory.instances.size()));
      for (uint32_t i = 0; i < resource.instance_count; ++i) {
        Subresource subresource;
        subresource.image = resource.type == ResourceType::image;
        if (resource.first_instance != no_instance)
          subresource.placement = resource.first_instance + i;
        subresource.with_host = resource.first_instance == no_instance;
        memory.add_instance(subresource, grids[r].count(), used[r]);
      }
    }
    in_place.assign(plan.resources.size(), 0);
    for (const PlanHistory& history : plan.histories)
      in_place[history.resource] =
          plan.resources[history.resource].instance_count == history.frames;
    for_each_kept([&](const PlanHistory&, uint32_t back, Layout layout, uint32_t index) {
      memory.set_kept(index, -int64_t{back}, layout);
    });
  }

  // Calls visit for each subresource that holds an earlier frame when this frame starts, and its
  // promised layout.
  template <class Visit> void for_each_kept(Visit visit) const {
    for (const PlanHistory& history : plan.histories)
      for (uint32_t i = history.range_count; i < (history.frames + 1) * history.range_count; ++i)
        for_each_subresource(history.resource, i / history.range_count,
                             plan.history_ranges[history.first_range + i % history.range_count],
                             [&](uint32_t index) {
                               visit(history, i / history.range_count,
                                     plan.history_layouts[history.first_layout + i], index);
                             });
  }

  uint32_t instance_of(uint32_t resource, uint32_t frames_back) const {
    const uint32_t count = plan.resources[resource].instance_count;
    return first_instance[resource] + (frame % count + count - frames_back % count) % count;
  }

  // Calls visit with the index of each subresource in the range.
  template <class Visit>
  void for_each_subresource(uint32_t resource, uint32_t frames_back, const SubresourceRange& range,
                            Visit visit) const {
    const uint32_t first = memory.instances[instance_of(resource, frames_back)].first;
    grids[resource].for_each_in(range, [&](uint32_t cell) { visit(first + cell); });
  }

  void object(const std::string& what, uint32_t resource, uint32_t frames_back,
              const std::string& where) {
    if (violations.size() < max_violations)
      violations.push_back(fmt::format("frame {}, {}: resource {}@-{}: {}", frame, where, resource,
                                       frames_back, what));
  }

  // Returns whether the check has exceeded its work limit.
  bool is_over() const { return work_done > max_work; }

  // Calls visit with the events of the subresource and of everything that shares memory with it,
  // after applying the waits so far.
  template <class Visit> void for_each_overlap(uint32_t index, Visit visit) {
    ++work_done;
    memory.for_each_overlap(index, [&](SubresourceEvents& there, bool own) {
      work_done += 1 + there.events.size();
      if (is_over()) return;
      for (Event& event : there.events) {
        work_done += event.visible.size();
        apply_waits(event);
      }
      visit(there, own);
    });
  }

  void begin_frame() {
    work_done += memory.subresources.size();
    for (Subresource& subresource : memory.subresources)
      subresource.returned_to_host = false;
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      if (in_place[r] != 0) continue; // still holds the oldest frame
      for_each_subresource(r, 0, plan.resources[r].whole(), [&](uint32_t index) {
        Subresource& current = memory.subresources[index];
        current.defined =
            current.placement == no_instance && plan.resources[r].origin == Origin::imported;
      });
    }
    for_each_kept([&](const PlanHistory& history, uint32_t back, Layout layout, uint32_t index) {
      if (memory.subresources[index].layout != layout)
        object("is not in the layout that the plan states for the start of a frame",
               history.resource, back, "start");
    });
  }

  bool starts_from(const Event& event, Stage source) const {
    const bool direct = event.queue == queue && event.stages != 0 && (event.stages & ~source) == 0;
    return direct || (event.ordered[index_of(queue)] & source) != 0;
  }

  void order(Event& event, Stage stages) const {
    event.ordered[index_of(queue)] |= stages;
    if (stages != 0) event.since[index_of(queue)] = std::min(event.since[index_of(queue)], now);
  }

  static void show(Event& event, const Visible& to) {
    const bool shown =
        std::any_of(event.visible.begin(), event.visible.end(), [&](const Visible& one) {
          return one.queue == to.queue && (to.stages & ~one.stages) == 0 &&
                 (to.access & ~one.access) == 0;
        });
    if (!shown) event.visible.push_back(to);
  }

  void extend(Event& event, const PlanBarrier& barrier) const {
    if (!starts_from(event, barrier.source_stages)) return;
    const bool direct =
        event.queue == queue && event.stages != 0 && (event.stages & ~barrier.source_stages) == 0;
    order(event, barrier.destination_stages);
    if (!event.is_write) return;
    Stage& after = event.after_available[index_of(queue)];
    const bool makes_available = direct && (event.writes & ~barrier.source_access) == 0;
    if (!makes_available && (after & barrier.source_stages) == 0) return;
    event.available = true;
    after |= barrier.destination_stages;
    show(event, {queue, barrier.destination_stages, barrier.destination_access});
  }

  // Applies waits: a wait orders and makes visible everything that the other queue had done, or had
  // been ordered after, when it reached the point. The loop repeats because one wait can extend
  // what a wait of the other queue implies.
  void apply_waits(Event& event) const {
    for (uint32_t unchanged = 0, q = 0; unchanged < queues; q ^= 1u, ++unchanged) {
      const size_t other = q ^ 1u;
      if (event.ordered[q] == everything) continue;
      int64_t needed_time = event.ordered[other] != 0 ? event.since[other] : never;
      if (index_of(event.queue) == other) needed_time = std::min(needed_time, event.at);
      if (needed_time == never || !waits[q].knows(needed_time)) continue;
      event.ordered[q] = everything;
      event.since[q] = std::min(event.since[q], waits[q].since(needed_time));
      event.available = true;
      event.after_available[q] = everything;
      if (event.is_write) show(event, {static_cast<Queue>(q), everything, everything});
      unchanged = 0;
    }
  }

  void report_violation(std::string what) {
    if (violations.size() < max_violations) violations.push_back(std::move(what));
  }

  void wait(uint32_t point, const std::string& where) {
    if (point == no_point) return;
    const size_t other = index_of(other_than(queue));
    const size_t awaited = points_before[other] + point;
    if (awaited > reached[other].size())
      report_violation(fmt::format("frame {}, {}: waits for point {} of the other queue, which is "
                                   "not signalled before the wait",
                                   frame, where, point));
    else if (awaited > 0) // 0: frames before the first, which need no wait
      waits[index_of(queue)].add(reached[other][awaited - 1], now);
  }

  void reach(uint32_t point, const std::string& where) {
    if (point == 0) return;
    std::vector<int64_t>& own = reached[index_of(queue)];
    if (point != own.size() - points_before[index_of(queue)] + 1)
      report_violation(
          fmt::format("frame {}, {}: signals point {} out of order", frame, where, point));
    own.push_back(now);
  }

  // Returns a layout transition as an event: a write that its own barrier has made available.
  Event transition_event(const PlanBarrier& barrier) const {
    Event event;
    event.is_write = event.available = true;
    event.queue = queue;
    event.at = now;
    order(event, barrier.destination_stages);
    event.after_available[index_of(queue)] = barrier.destination_stages;
    event.visible = {{queue, barrier.destination_stages, barrier.destination_access}};
    return event;
  }

  // Moves the subresource between queues as the barrier says, and reports it if that is not
  // allowed.
  void change_queue(Subresource& subresource, const PlanBarrier& barrier, const auto& wrong) {
    const bool discarded = subresource.image && barrier.old_layout == Layout::undefined;
    switch (barrier.transfer) {
    case PlanBarrier::Transfer::none:
      if (discarded || (!subresource.image && !subresource.in_transfer)) {
        if (subresource.image) subresource.queue = queue;
        subresource.in_transfer = false;
      } else if (subresource.queue != queue || subresource.in_transfer) {
        wrong("has a barrier on a queue that does not own it");
      }
      break;
    case PlanBarrier::Transfer::release:
      if (subresource.queue != queue || subresource.in_transfer)
        wrong("is released by a queue that does not own it");
      subresource.in_transfer = true;
      subresource.released_old = barrier.old_layout;
      subresource.released_new = barrier.new_layout;
      break;
    case PlanBarrier::Transfer::acquire:
      if (subresource.queue == queue || !subresource.in_transfer)
        wrong("is acquired without a release by the other queue");
      if (subresource.released_old != barrier.old_layout ||
          subresource.released_new != barrier.new_layout)
        wrong("is acquired with different layouts than it was released with");
      subresource.queue = queue;
      subresource.in_transfer = false;
      break;
    }
  }

  void run(const PlanBarrier& barrier, const std::string& where) {
    for_each_subresource(barrier.resource, barrier.frames_back, barrier.range,
                         [&](uint32_t index) { run(barrier, index, where); });
  }

  void run(const PlanBarrier& barrier, uint32_t index, const std::string& where) {
    ++work_done;
    if (is_over()) return;
    Subresource& subresource = memory.subresources[index];
    const auto wrong = [&](const char* what) {
      object(what, barrier.resource, barrier.frames_back, where);
    };
    if (barrier.to_host) {
      if (subresource.placement != no_instance)
        wrong("is returned to the host, which does not own it");
      if (subresource.returned_to_host) wrong("is returned to the host twice");
      subresource.returned_to_host = true;
    }
    if ((barrier.from_host || barrier.to_host) && queue != Queue::main)
      wrong("is owned by the host, but used on the async queue");
    if (barrier.from_host) {
      if (!subresource.with_host) wrong("is acquired from the host twice");
      subresource.with_host = barrier.to_host;
      subresource.layout = barrier.new_layout;
      memory.add_write(index, transition_event(barrier));
      return;
    }
    if (subresource.with_host) wrong("has a barrier while the host owns it");
    change_queue(subresource, barrier, wrong);
    const bool release = barrier.transfer == PlanBarrier::Transfer::release;
    const bool transition = barrier.to_host || barrier.transfer != PlanBarrier::Transfer::none ||
                            (subresource.image && barrier.old_layout != barrier.new_layout);
    if (subresource.image && barrier.old_layout != Layout::undefined &&
        barrier.old_layout != subresource.layout)
      wrong("has a barrier whose old layout is not its layout");
    if (subresource.image && barrier.old_layout == Layout::undefined) {
      if (!barrier.to_host && barrier.new_layout == Layout::undefined)
        wrong("has a barrier whose new layout is undefined");
      if (subresource.defined && (subresource.placement == no_instance ||
                                  subresource.of_frame == int64_t{frame} - barrier.frames_back))
        wrong("has a barrier that discards its contents, which are still needed");
      subresource.defined = false;
    }
    memory.isolate(index);
    for_each_overlap(index, [&](SubresourceEvents& there, bool) {
      for (Event& event : there.events) {
        extend(event, barrier);
        if (!transition) continue;
        if (!starts_from(event, barrier.source_stages))
          wrong("changes layout before an earlier access is done");
        if (event.is_write && !event.available)
          wrong("changes layout before an earlier write is available");
      }
    });
    if (!transition) return;
    if (!release) subresource.layout = barrier.new_layout;
    memory.add_write(index, transition_event(barrier));
    subresource.with_host = barrier.to_host;
  }

  void run(const PlanBarrier* barriers, uint32_t count, bool releases, const std::string& where) {
    for (uint32_t b = 0; b < count && !is_over(); ++b) {
      if ((barriers[b].transfer == PlanBarrier::Transfer::release) != releases)
        report_violation(fmt::format(
            "frame {}, {}: a release belongs after a pass, and all other barriers belong before it",
            frame, where));
      run(barriers[b], where);
    }
  }

  bool visible(const Event& write, Stage stages, Access accesses) const {
    return std::any_of(write.visible.begin(), write.visible.end(), [&](const Visible& to) {
      return to.queue == queue && (stages & ~to.stages) == 0 && (accesses & ~to.access) == 0;
    });
  }

  void check(const PlanAccess& access, const std::string& where) {
    for_each_subresource(access.resource, access.frames_back, access.range,
                         [&](uint32_t index) { check(access, index, where); });
  }

  void check(const PlanAccess& access, uint32_t index, const std::string& where) {
    if (is_over()) return;
    const Subresource& subresource = memory.subresources[index];
    const auto wrong = [&](const char* what) {
      object(what, access.resource, access.frames_back, where);
    };
    const Access as_read = access.access & ~all_write_access,
                 as_write = access.access & all_write_access;
    // An internally ordered access reads only what its own pass writes.
    const bool reads = as_read != 0 && !access.internally_ordered, writes = as_write != 0;
    if (subresource.with_host) return wrong("is accessed while the host owns it");
    if (writes && access.frames_back > 0) wrong("is written, although it holds an earlier frame");
    if (subresource.in_transfer || (subresource.queue != queue && (subresource.image || reads)))
      wrong("is accessed by a queue that does not own it");
    if (subresource.image && subresource.layout != access.layout)
      wrong("is not in the layout that the plan states for the access");
    if (reads && !subresource.defined) wrong("is read, but its contents are not defined");
    if (reads && subresource.defined && subresource.placement != no_instance &&
        plan.placements[subresource.placement].persistent &&
        subresource.of_frame != int64_t{frame} - access.frames_back)
      wrong("is read, but holds the contents of another frame");
    for_each_overlap(index, [&](const SubresourceEvents& there, bool own) {
      bool followed = false; // a later access happens in every frame
      for (size_t e = there.events.size(); e-- > 0;) {
        const Event& event = there.events[e];
        const bool ordered = (access.stages & ~event.ordered[index_of(queue)]) == 0;
        if ((event.is_write || writes) && !ordered)
          wrong("is accessed before an earlier access is done");
        if (writes && event.is_write && !event.available)
          wrong("is written before an earlier write is available");
        if (reads && own && event.is_write && !visible(event, access.stages, as_read))
          wrong("is read before the last write is visible");
        // If a read of every frame followed the write, waiting for that read is enough.
        if (writes && event.is_write && !followed && !visible(event, access.stages, as_write))
          wrong("is written before the last write is visible");
        followed |= event.certain;
      }
    });
  }

  void record_access(const PlanAccess& access, uint32_t index) {
    Event event;
    event.access = &access;
    event.stages = access.stages;
    event.writes = access.access & all_write_access;
    event.is_write = event.writes != 0;
    event.certain = access.when == ReadWhen::always;
    event.queue = queue;
    event.at = now;
    if (!event.is_write) return memory.add_read(index, event);
    Subresource& subresource = memory.subresources[index];
    subresource.defined = true;
    subresource.of_frame = int64_t{frame} - access.frames_back;
    subresource.queue = queue;
    memory.add_write(index, event);
  }

  // Checks the orderings that `after` requests: earlier passes come first, and earlier passes of
  // the other queue are waited for.
  void check_orderings(uint32_t position, const std::string& where) {
    const auto [first, last] =
        std::equal_range(plan.orderings.begin(), plan.orderings.end(), PlanOrdering{0, position});
    for (auto at = first; at != last; ++at) {
      const bool known = plan.passes[at->earlier].queue == queue ||
                         waits[index_of(queue)].knows(frame_began + at->earlier + 1);
      if (at->earlier >= position || !known)
        report_violation(
            fmt::format("frame {}, {}: does not run after pass {}, as the graph requires", frame,
                        where, at->earlier));
    }
  }

  void run(const PlanPass& pass, const std::string& where) {
    const PlanAccess* accesses = plan.accesses.data() + pass.first_access;
    queue = pass.queue;
    ++now;
    wait(pass.wait, where);
    check_orderings(static_cast<uint32_t>(&pass - plan.passes.data()), where);
    run(plan.barriers.data() + pass.first_barrier, pass.barrier_count, false, where);
    for (uint32_t a = 0; a < pass.access_count && !is_over(); ++a)
      check(accesses[a], where);
    work_done += uint64_t{pass.access_count} * pass.access_count;
    if (is_over()) return;
    for (const PassRace& race : races_within(plan, pass, frame))
      object(race.what, race.resource, race.frames_back, where);
    for (uint32_t a = 0; a < pass.access_count; ++a)
      for_each_subresource(accesses[a].resource, accesses[a].frames_back, accesses[a].range,
                           [&](uint32_t index) { record_access(accesses[a], index); });
    run(plan.barriers.data() + pass.first_barrier + pass.barrier_count, pass.release_count, true,
        where);
    reach(pass.signal, where);
  }

  void run_frame() {
    begin_frame();
    frame_began = now;
    for (uint32_t p = 0; p < plan.passes.size() && !is_over(); ++p, ++work_done)
      run(plan.passes[p], fmt::format("pass {}", p));
    if (is_over()) return;
    queue = Queue::main;
    ++now;
    wait(plan.final_wait, "final batch");
    run(plan.barriers.data() + plan.first_final_barrier, plan.final_barrier_count, false,
        "final batch");
    for (uint32_t r = 0; r < plan.resources.size(); ++r)
      if (plan.resources[r].first_instance == no_instance &&
          !memory.subresources[memory.instances[first_instance[r]].first].returned_to_host)
        object("is not returned to the host", r, 0, "end");
    for (size_t q = 0; q < queues; ++q)
      points_before[q] = reached[q].size();
    ++frame;
  }
};

} // namespace

Verdict verify(const Plan& plan) {
  auto violations = verify_structure(plan);
  if (!violations.empty()) return {std::move(violations), ""};
  // the first frame, one that follows it, and one that follows a frame like itself
  uint32_t frames = 3;
  for (const PlanHistory& history : plan.histories)
    frames = std::max(frames, history.frames + 3);
  // The use of one instance too many is detected once that instance has become the oldest.
  for (const PlanResource& resource : plan.resources)
    frames = std::max(frames, 2 * resource.instance_count + 1);
  std::vector<SubresourceGrid> grids = subresource_grids(plan);
  uint64_t subresources = 0;
  for (size_t r = 0; r < grids.size(); ++r)
    subresources += uint64_t{grids[r].count()} * plan.resources[r].instance_count;
  if (subresources > max_subresources)
    return {{},
            fmt::format("it divides its images into {} subresources, more than {}", subresources,
                        max_subresources)};
  Machine machine{plan, std::move(grids)};
  machine.prepare();
  for (uint32_t f = 0; f < frames && machine.violations.empty() && !machine.is_over(); ++f)
    machine.run_frame();
  Verdict verdict{std::move(machine.violations), ""};
  if (machine.is_over())
    verdict.not_verified =
        fmt::format("the verifier would take more than {} steps for it", max_work);
  return verdict;
}

} // namespace dermis
