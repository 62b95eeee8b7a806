// The rules that the model of things.hpp holds a plan to: one frame after the other, barrier by barrier and
// access by access.

#include "framegraph/verify/verify.hpp"

#include "framegraph/verify/overlaps.hpp"
#include "framegraph/verify/parts.hpp"
#include "framegraph/verify/structure.hpp"
#include "framegraph/verify/things.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace dermis {
namespace {

// A hostile plan could divide images, and accesses by barriers for some of their bytes, without end.
constexpr uint64_t most_things = 1u << 18, most_pieces = 1u << 21;
// Nor could it let all its memory meet without end: each access is held against earlier ones to the same
// bytes. A chain of 4,096 passes, the longest that a graph may have, takes 3.3e8 looks.
constexpr uint64_t most_looks = 1u << 30;

struct Machine {
  const Plan& plan;
  const std::vector<ResourceParts> parts; // by resource
  std::vector<Thing> things = {};
  std::vector<InstanceThings> instances = {};
  std::vector<uint32_t> first_instance = {};           // by resource: into instances
  std::vector<std::vector<uint32_t>> overlapping = {}; // by instance: others with a byte in common
  std::vector<std::string> objections = {};
  uint32_t frame = 0;
  Queue queue = Queue::main;                             // that runs now
  int64_t now = 0;                                       // which pass, counted through all frames
  std::array<std::vector<int64_t>, queues> reached = {}; // by queue and point: the pass behind which it was
  std::array<size_t, queues> points_before = {};         // those of earlier frames
  std::array<int64_t, queues> waited = {};               // by queue: the last pass of the other one it knows
  int64_t frame_began = 0;                               // behind which pass
  uint64_t pieces = 0;                                   // that barriers made of events
  uint64_t looks = 0;                                    // at what shares memory

  void prepare() {
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      const PlanResource& resource = plan.resources[r];
      first_instance.push_back(static_cast<uint32_t>(instances.size()));
      for (uint32_t i = 0; i < resource.instance_count; ++i) {
        Thing thing;
        thing.owner = static_cast<uint32_t>(instances.size());
        thing.image = resource.type == ResourceType::image;
        if (resource.first_instance != no_instance) thing.placement = resource.first_instance + i;
        thing.with_host = resource.first_instance == no_instance;
        instances.push_back({static_cast<uint32_t>(things.size()), parts[r].count(), thing.placement});
        things.insert(things.end(), parts[r].count(), thing);
      }
    }
    overlapping = overlaps_of(plan, instances);
    // As if the executor had just made them.
    for_each_kept([&](const PlanHistory&, uint32_t back, Layout layout, uint32_t index) {
      things[index].defined = true;
      things[index].of_frame = -int64_t{back};
      things[index].layout = layout;
    });
  }

  // Calls with each thing that holds an earlier frame when this one starts, and the layout promised then.
  template <class Visit> void for_each_kept(Visit visit) const {
    for (const PlanHistory& history : plan.histories)
      for (uint32_t i = history.parts; i < (history.frames + 1) * history.parts; ++i)
        for_each_part(history.resource, i / history.parts,
                      plan.history_parts[history.first_part + i % history.parts], [&](uint32_t index) {
                        visit(history, i / history.parts, plan.history_layouts[history.first_layout + i],
                              index);
                      });
  }

  uint32_t instance_of(uint32_t resource, uint32_t frames_back) const {
    const uint32_t count = plan.resources[resource].instance_count;
    return first_instance[resource] + (frame % count + count - frames_back % count) % count;
  }

  // Calls with the index of each thing in the range.
  template <class Visit>
  void for_each_part(uint32_t resource, uint32_t frames_back, const SubresourceRange& range,
                     Visit visit) const {
    const uint32_t first = instances[instance_of(resource, frames_back)].first;
    parts[resource].for_each_in(range, [&](uint32_t part) { visit(first + part); });
  }

  void object(const std::string& what, uint32_t resource, uint32_t frames_back, const std::string& where) {
    if (objections.size() < most_objections)
      objections.push_back(
          fmt::format("frame {}, {}: resource {}@-{}: {}", frame, where, resource, frames_back, what));
  }

  // Counts what is looked at; false, and an objection, once it is too much to go on.
  bool may_look(uint64_t count) {
    looks += count;
    if (looks <= most_looks) return true;
    if (looks - count <= most_looks)
      complain(
          fmt::format("accesses meet in memory more than {} times: too often to be verified", most_looks));
    return false;
  }

  template <class Visit> void for_each_overlapping(uint32_t index, Visit visit) {
    visit(things[index], true);
    for (const uint32_t i : overlapping[things[index].owner])
      for (uint32_t t = instances[i].first; t < instances[i].first + instances[i].count; ++t) {
        if (!may_look(1 + things[t].events.size())) return;
        visit(things[t], false);
      }
  }

  Bytes bytes_of(uint32_t index) const {
    const uint32_t placement = things[index].placement;
    if (placement == no_instance) return {}; // the host's: nothing else lies there
    const Placement& memory = plan.placements[placement];
    return {memory.offset, memory.offset + memory.size};
  }

  // What a barrier for these bytes orders of an event, and what it does not, part ways.
  void divide(std::vector<Event>& events, const Bytes& by, Stage source) {
    for (size_t e = 0; e < events.size(); ++e) {
      const Bytes whole = events[e].bytes;
      if (whole.within(by) || !whole.meets(by) || !starts_from(events[e], source)) continue;
      if (++pieces > most_pieces) return complain("barriers divide memory into too many pieces");
      const auto cut = [&](uint64_t at) { // the upper piece stands behind the lower one
        events[e].bytes.end = at;
        events.insert(events.begin() + static_cast<std::ptrdiff_t>(e) + 1, events[e]);
        events[++e].bytes = {at, whole.end};
      };
      if (whole.begin < by.begin) cut(by.begin);
      if (whole.end > by.end) cut(by.end);
    }
  }

  bool renewed_in_place(uint32_t resource) const {
    return std::any_of(plan.histories.begin(), plan.histories.end(), [&](const PlanHistory& history) {
      return history.resource == resource && plan.resources[resource].instance_count == history.frames;
    });
  }

  void begin_frame() {
    for (Thing& thing : things)
      thing.handed_back = false;
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      if (renewed_in_place(r)) continue; // it holds the oldest frame still
      for_each_part(r, 0, plan.resources[r].whole(), [&](uint32_t index) {
        Thing& current = things[index];
        current.defined = current.placement == no_instance && plan.resources[r].origin == Origin::imported;
      });
    }
    for_each_kept([&](const PlanHistory& history, uint32_t back, Layout layout, uint32_t index) {
      if (things[index].layout != layout)
        object("is not in the layout the plan promises at the start of a frame", history.resource, back,
               "start");
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

  void extend(Event& event, const PlanBarrier& barrier) const {
    if (!starts_from(event, barrier.source_stages)) return;
    const bool direct =
        event.queue == queue && event.stages != 0 && (event.stages & ~barrier.source_stages) == 0;
    order(event, barrier.destination_stages);
    if (!event.is_write) return;
    if (direct && (event.writes & ~barrier.source_access) == 0) event.available = true;
    if (event.available)
      event.visible.push_back({queue, barrier.destination_stages, barrier.destination_access});
  }

  // Whatever the other queue had done by then, or had been ordered behind.
  void wait_for_pass(int64_t pass) {
    const size_t other = index_of(other_than(queue));
    for (Thing& thing : things)
      for (Event& event : thing.events) {
        const bool done = event.queue != queue && event.at <= pass;
        if (!done && (event.ordered[other] == 0 || event.since[other] > pass)) continue;
        order(event, everything);
        event.available = true;
        if (event.is_write) event.visible.push_back({queue, everything, everything});
      }
  }

  void complain(std::string what) {
    if (objections.size() < most_objections) objections.push_back(std::move(what));
  }

  void wait(uint32_t point, const std::string& where) {
    if (point == no_point) return;
    const size_t other = index_of(other_than(queue));
    const size_t wanted = points_before[other] + point;
    if (wanted > reached[other].size())
      complain(
          fmt::format("frame {}, {}: waits for point {} of the other queue, which is not reached before it",
                      frame, where, point));
    else if (wanted > 0) { // else the frames before the first, which nobody waits for
      wait_for_pass(reached[other][wanted - 1]);
      int64_t& known = waited[index_of(queue)];
      known = std::max(known, reached[other][wanted - 1]);
    }
  }

  void reach(uint32_t point, const std::string& where) {
    if (point == 0) return;
    std::vector<int64_t>& own = reached[index_of(queue)];
    if (point != own.size() - points_before[index_of(queue)] + 1)
      complain(fmt::format("frame {}, {}: reaches point {} out of turn", frame, where, point));
    own.push_back(now);
  }

  // A transition, as a write that its own barrier has made available.
  Event left_by(const PlanBarrier& barrier, const Bytes& bytes) const {
    Event event;
    event.bytes = bytes;
    event.is_write = event.available = true;
    event.queue = queue;
    event.at = now;
    order(event, barrier.destination_stages);
    event.visible = {{queue, barrier.destination_stages, barrier.destination_access}};
    return event;
  }

  // Whether the thing may go from queue to queue as the barrier says; it does so.
  void change_queue(Thing& thing, const PlanBarrier& barrier, const auto& wrong) {
    const bool discarded = thing.image && barrier.old_layout == Layout::undefined;
    switch (barrier.transfer) {
    case PlanBarrier::Transfer::none:
      if (discarded || (!thing.image && !thing.in_transfer)) {
        if (thing.image) thing.queue = queue;
        thing.in_transfer = false;
      } else if (thing.queue != queue || thing.in_transfer) {
        wrong("has a barrier on a queue that it does not belong to");
      }
      break;
    case PlanBarrier::Transfer::release:
      if (thing.queue != queue || thing.in_transfer)
        wrong("is released by a queue that it does not belong to");
      thing.in_transfer = true;
      thing.released_old = barrier.old_layout;
      thing.released_new = barrier.new_layout;
      break;
    case PlanBarrier::Transfer::acquire:
      if (thing.queue == queue || !thing.in_transfer)
        wrong("is acquired, but the other queue has not released it");
      if (thing.released_old != barrier.old_layout || thing.released_new != barrier.new_layout)
        wrong("is acquired in other layouts than it was released in");
      thing.queue = queue;
      thing.in_transfer = false;
      break;
    }
  }

  void run(const PlanBarrier& barrier, const std::string& where) {
    for_each_part(barrier.resource, barrier.frames_back, barrier.range,
                  [&](uint32_t index) { run(barrier, index, where); });
  }

  void run(const PlanBarrier& barrier, uint32_t index, const std::string& where) {
    Thing& thing = things[index];
    const auto wrong = [&](const char* what) { object(what, barrier.resource, barrier.frames_back, where); };
    if (barrier.to_host) {
      if (thing.placement != no_instance) wrong("is handed to the host, but is not the host's");
      if (thing.handed_back) wrong("is handed back to the host twice");
      thing.handed_back = true;
    }
    if ((barrier.from_host || barrier.to_host) && queue != Queue::main)
      wrong("is the host's on the async queue");
    if (barrier.from_host) {
      if (!thing.with_host) wrong("is taken over from the host twice");
      thing.with_host = barrier.to_host;
      thing.layout = barrier.new_layout;
      thing.events = {left_by(barrier, bytes_of(index))};
      return;
    }
    if (thing.with_host) wrong("has a barrier while it is the host's");
    change_queue(thing, barrier, wrong);
    const bool release = barrier.transfer == PlanBarrier::Transfer::release;
    const bool transition = barrier.to_host || barrier.transfer != PlanBarrier::Transfer::none ||
                            (thing.image && barrier.old_layout != barrier.new_layout);
    if (thing.image && barrier.old_layout != Layout::undefined && barrier.old_layout != thing.layout)
      wrong("has a barrier from a layout it is not in");
    if (thing.image && barrier.old_layout == Layout::undefined) {
      if (!barrier.to_host && barrier.new_layout == Layout::undefined) wrong("is moved to no layout");
      thing.defined = false;
    }
    const Bytes bytes = bytes_of(index);
    for_each_overlapping(index, [&](Thing& other, bool own) {
      divide(other.events, bytes, barrier.source_stages);
      for (Event& event : other.events) {
        if (!event.bytes.meets(bytes)) continue;
        extend(event, barrier);
        if (!transition) continue;
        if (!starts_from(event, barrier.source_stages))
          wrong("changes layout before an earlier access is done");
        if (event.is_write && !event.available) wrong("changes layout before an earlier write is available");
      }
      if (transition && !own) other.defined = false;
    });
    if (!transition) return;
    if (!release) thing.layout = barrier.new_layout;
    thing.events = {left_by(barrier, bytes)};
    thing.with_host = barrier.to_host;
  }

  void run(const PlanBarrier* barriers, uint32_t count, bool releases, const std::string& where) {
    for (uint32_t b = 0; b < count; ++b) {
      if ((barriers[b].transfer == PlanBarrier::Transfer::release) != releases)
        complain(fmt::format("frame {}, {}: a release stands behind a pass, everything else before it", frame,
                             where));
      run(barriers[b], where);
    }
  }

  bool visible(const Event& write, Stage stages, Access accesses) const {
    return std::any_of(write.visible.begin(), write.visible.end(), [&](const Visible& to) {
      return to.queue == queue && (stages & ~to.stages) == 0 && (accesses & ~to.access) == 0;
    });
  }

  void check(const PlanAccess& access, const std::string& where) {
    for_each_part(access.resource, access.frames_back, access.range,
                  [&](uint32_t index) { check(access, index, where); });
  }

  void check(const PlanAccess& access, uint32_t index, const std::string& where) {
    const Thing& thing = things[index];
    const auto wrong = [&](const char* what) { object(what, access.resource, access.frames_back, where); };
    const Access as_read = access.access & ~all_write_access, as_write = access.access & all_write_access;
    const bool reads = as_read != 0, writes = as_write != 0;
    if (thing.with_host) return wrong("is touched while it is the host's");
    if (thing.in_transfer || (thing.queue != queue && (thing.image || reads)))
      wrong("is touched by a queue that it does not belong to");
    if (thing.image && thing.layout != access.layout)
      wrong("is not in the layout the access was planned with");
    if (reads && !thing.defined) wrong("is read, but its contents are not defined");
    if (reads && thing.defined && thing.placement != no_instance &&
        plan.placements[thing.placement].persistent && thing.of_frame != int64_t{frame} - access.frames_back)
      wrong("is read, but holds the contents of another frame");
    const Bytes bytes = bytes_of(index);
    for_each_overlapping(index, [&](const Thing& other, bool own) {
      bool followed = false,
           certain = false; // by an access of every frame; this event, or a piece of it, is one
      for (size_t e = other.events.size(); e-- > 0;) {
        const Event& event = other.events[e];
        const bool piece = e + 1 < other.events.size() && event.at == other.events[e + 1].at &&
                           event.access == other.events[e + 1].access;
        followed |= !piece && certain;
        certain = event.certain || (piece && certain);
        if (!event.bytes.meets(bytes)) continue;
        const bool ordered = (access.stages & ~event.ordered[index_of(queue)]) == 0;
        if ((event.is_write || writes) && !ordered) wrong("is touched before an earlier access is done");
        if (writes && event.is_write && !event.available)
          wrong("is written before an earlier write is available");
        if (reads && own && event.is_write && !visible(event, access.stages, as_read))
          wrong("is read where the last write is not visible");
        // Where it was read since, in this frame whatever is valid, the wait for the reader is enough.
        if (writes && event.is_write && !followed && !visible(event, access.stages, as_write))
          wrong("is written where the last write is not visible");
      }
    });
  }

  // Two frames of a history in one thing, one read and one written by the same pass.
  void check_own_texels(const PlanAccess* accesses, uint32_t count, const PlanAccess& read,
                        const std::string& where) {
    if ((read.access & ~all_write_access) == 0 || read.own_texels) return;
    const auto overwrites = [&](const PlanAccess& write) {
      return (write.access & all_write_access) != 0 && write.resource == read.resource &&
             write.frames_back != read.frames_back && meet(write.range, read.range) &&
             instance_of(write.resource, write.frames_back) == instance_of(read.resource, read.frames_back);
    };
    if (std::any_of(accesses, accesses + count, overwrites))
      object("is written over by the pass that reads it, not texel by texel", read.resource, read.frames_back,
             where);
  }

  void leave(const PlanAccess& access, uint32_t index, bool first_of_pass) {
    const Access writes = access.access & all_write_access;
    Thing& thing = things[index];
    if (writes != 0) {
      for_each_overlapping(index, [&](Thing& other, bool own) {
        if (!own) other.defined = false;
      });
      // Everything before is ordered before this write, so whatever waits for the write waits for it too.
      if (first_of_pass) thing.events.clear();
      thing.defined = true;
      thing.of_frame = int64_t{frame} - access.frames_back;
      thing.queue = queue;
    }
    Event event;
    event.bytes = bytes_of(index);
    event.access = &access;
    event.stages = access.stages;
    event.writes = writes;
    event.is_write = writes != 0;
    event.certain = access.when == ReadWhen::always;
    event.queue = queue;
    event.at = now;
    thing.events.push_back(event);
  }

  // Passes that `after` names stand before this one; those of the other queue are waited for.
  void check_orderings(uint32_t position, const std::string& where) {
    const auto [first, last] =
        std::equal_range(plan.orderings.begin(), plan.orderings.end(), PlanOrdering{0, position});
    for (auto at = first; at != last; ++at) {
      const bool known =
          plan.passes[at->earlier].queue == queue || waited[index_of(queue)] > frame_began + at->earlier;
      if (at->earlier >= position || !known)
        complain(
            fmt::format("frame {}, {}: does not come after pass {}, as it is to", frame, where, at->earlier));
    }
  }

  void run(const PlanPass& pass, const std::string& where) {
    const PlanAccess* accesses = plan.accesses.data() + pass.first_access;
    queue = pass.queue;
    ++now;
    wait(pass.wait, where);
    check_orderings(static_cast<uint32_t>(&pass - plan.passes.data()), where);
    run(plan.barriers.data() + pass.first_barrier, pass.barrier_count, false, where);
    for (uint32_t a = 0; a < pass.access_count; ++a) {
      check(accesses[a], where);
      check_own_texels(accesses, pass.access_count, accesses[a], where);
    }
    for (uint32_t a = 0; a < pass.access_count; ++a) {
      const ResourceParts& own = parts[accesses[a].resource];
      own.for_each_in(accesses[a].range, [&](uint32_t part) {
        const SubresourceRange at = own.begin_of(part);
        const bool first = std::none_of(accesses, accesses + a, [&](const PlanAccess& earlier) {
          return earlier.resource == accesses[a].resource && earlier.frames_back == accesses[a].frames_back &&
                 meet(earlier.range, at);
        });
        const uint32_t instance = instance_of(accesses[a].resource, accesses[a].frames_back);
        leave(accesses[a], instances[instance].first + part, first);
      });
    }
    run(plan.barriers.data() + pass.first_barrier + pass.barrier_count, pass.release_count, true, where);
    reach(pass.signal, where);
  }

  void run_frame() {
    begin_frame();
    frame_began = now;
    for (uint32_t p = 0; p < plan.passes.size(); ++p)
      run(plan.passes[p], fmt::format("pass {}", p));
    queue = Queue::main;
    ++now;
    wait(plan.final_wait, "final batch");
    run(plan.barriers.data() + plan.first_final_barrier, plan.final_barrier_count, false, "final batch");
    for (uint32_t r = 0; r < plan.resources.size(); ++r)
      if (plan.resources[r].first_instance == no_instance &&
          !things[instances[first_instance[r]].first].handed_back)
        object("is not handed back to the host", r, 0, "end");
    for (size_t q = 0; q < queues; ++q)
      points_before[q] = reached[q].size();
    ++frame;
  }
};

} // namespace

std::vector<std::string> verify(const Plan& plan) {
  auto objections = verify_structure(plan);
  if (!objections.empty()) return objections;
  uint32_t frames = 3; // the first, one that follows it, and one that follows a frame like itself
  for (const PlanHistory& history : plan.histories)
    frames = std::max(frames, history.frames + 3);
  for (const PlanResource& resource : plan.resources) // whoever uses one instance too many is found out when
    frames = std::max(frames, 2 * resource.instance_count + 1); // that has become the oldest
  std::vector<ResourceParts> parts = parts_of(plan);
  uint64_t things = 0;
  for (size_t r = 0; r < parts.size(); ++r)
    things += uint64_t{parts[r].count()} * plan.resources[r].instance_count;
  if (things > most_things) return {"the plan tells too many parts of images apart"};
  Machine machine{plan, std::move(parts)};
  machine.prepare();
  for (uint32_t f = 0; f < frames && machine.objections.empty(); ++f)
    machine.run_frame();
  return std::move(machine.objections);
}

} // namespace dermis
