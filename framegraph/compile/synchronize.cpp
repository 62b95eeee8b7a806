// What must wait for what. Each object (a resource, or one of its earlier frames) is walked through the frame
// on its own: every access either finds the contents visible, in the right layout, or gets one barrier before
// its pass.

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

struct Scope {
  Stage stages = 0;
  Access access = 0;
};

// All accesses of one pass to one object.
struct Touch {
  uint32_t position = 0;     // in Plan::passes
  std::vector<Scope> scopes; // one per port
  Stage stages = 0;          // their union
  Access access = 0;
  Layout layout = Layout::undefined;
  bool reads = false, writes = false;
};

// How one object stands between two accesses.
struct State {
  bool touched = false;
  Layout layout = Layout::undefined;
  // What the next dependency on the contents must wait for: the last write, or (behind a layout transition,
  // which is a write of its own) what that transition was made visible to. `access` is 0 once the write is
  // available.
  Scope source;
  Stage readers = 0;             // stages that read since
  std::vector<Scope> visible;    // where the contents may be read without another barrier
  uint32_t last_pass = no_value; // position; in the frame before while `carried`
  bool carried = false;          // from the frame before
};

// Where a dependency on everything done so far starts.
Scope tail(const State& state) {
  if (!state.touched) return {};
  return {state.readers != 0 && state.source.access == 0 ? state.readers
                                                         : state.source.stages | state.readers,
          state.source.access};
}

bool visible_to(const State& state, const Touch& touch) {
  return std::all_of(touch.scopes.begin(), touch.scopes.end(), [&](const Scope& wanted) {
    return std::any_of(state.visible.begin(), state.visible.end(), [&](const Scope& has) {
      return (wanted.stages & ~has.stages) == 0 && (wanted.access & ~has.access) == 0;
    });
  });
}

// Fills in the barrier that `touch` needs behind `state`; false if it needs none.
bool dependency(const State& state, const Touch& touch, PlanBarrier& barrier) {
  const bool pending = state.source.access != 0;
  const bool must_see = touch.reads && !visible_to(state, touch);
  const Scope everything = tail(state);
  barrier.source_stages = everything.stages;
  barrier.source_access = everything.access;
  barrier.destination_stages = touch.stages;
  barrier.destination_access = touch.access;
  barrier.old_layout = state.layout;
  barrier.new_layout = touch.layout;
  if (touch.layout != state.layout) {
    barrier.why = !pending      ? PlanBarrier::Why::layout
                  : touch.reads ? PlanBarrier::Why::read_after_write
                                : PlanBarrier::Why::write_after_write;
    return true;
  }
  if (must_see) {
    barrier.why = PlanBarrier::Why::read_after_write;
    barrier.source_stages = touch.writes ? everything.stages | state.source.stages : state.source.stages;
    return true;
  }
  if (!touch.writes) return false;
  barrier.why = pending ? PlanBarrier::Why::write_after_write : PlanBarrier::Why::write_after_read;
  if (!pending) barrier.destination_access = 0; // readers only have to be done: nothing to make visible
  return true;
}

void advance(State& state, const Touch& touch, bool waited) {
  const bool transition = !state.touched || touch.layout != state.layout;
  if (touch.writes || transition) {
    state.source = {touch.stages, touch.access & all_write_access};
    state.readers = 0;
    state.visible.clear();
  }
  if (!touch.writes) {
    if (waited) {
      state.source.access = 0;
      state.visible.insert(state.visible.end(), touch.scopes.begin(), touch.scopes.end());
    }
    state.readers |= touch.stages;
  }
  state.touched = true;
  state.carried = false;
  state.layout = touch.layout;
  state.last_pass = touch.position;
}

struct Planned { // a barrier and where it goes
  uint32_t position;
  PlanBarrier barrier;
  std::string reason;
};

struct Synchronizer {
  CompileContext& c;
  Plan& plan;
  std::vector<uint32_t> first_object;      // by plan resource; objects follow frames_back
  std::vector<std::vector<Touch>> touches; // by object
  std::vector<State> ends;                 // by object: how it stands when the frame is over
  std::vector<Planned> planned;

  explicit Synchronizer(CompileContext& context) : c(context), plan(context.out.plan) {
    for (const PlanResource& resource : plan.resources) {
      first_object.push_back(static_cast<uint32_t>(touches.size()));
      touches.resize(touches.size() + resource.instance_count);
    }
    ends.resize(touches.size());
  }

  const std::string& name(uint32_t resource) const { return c.name(plan.resources[resource].declared); }
  const std::string& pass_name(uint32_t position) const { return c.name(plan.passes[position].declared); }
  bool host_owned(uint32_t resource) const { return c.host_owned(plan.resources[resource].declared); }

  // One layout for all ports of a pass that see the same image: `general` serves every one of them.
  static void merge(Touch& touch, const UsageInfo& usage, bool image) {
    const Layout layout = image ? usage.layout : Layout::undefined;
    touch.layout = touch.scopes.empty() || touch.layout == layout ? layout : Layout::general;
    touch.scopes.push_back({usage.stages, usage.access});
    touch.stages |= usage.stages;
    touch.access |= usage.access;
    touch.reads |= usage.reads;
    touch.writes |= usage.writes;
  }

  void collect() {
    for (uint32_t position = 0; position < plan.passes.size(); ++position) {
      PlanPass& pass = plan.passes[position];
      pass.first_access = static_cast<uint32_t>(plan.accesses.size());
      for (uint32_t u = c.first_use[pass.declared.value]; u < c.first_use[pass.declared.value + 1]; ++u) {
        const Use& use = c.uses[u];
        if (use.trouble != Use::Trouble::none) continue;
        const UsageInfo& usage = usage_info(use.usage);
        const uint32_t resource = c.plan_resource[use.resource.value];
        auto& list = touches[first_object[resource] + use.frames_back];
        if (list.empty() || list.back().position != position) list.emplace_back().position = position;
        merge(list.back(), usage, plan.resources[resource].type == ResourceType::image);
        plan.accesses.push_back({use.port, resource, use.frames_back, usage.stages, usage.access, {}});
      }
      pass.access_count = static_cast<uint32_t>(plan.accesses.size()) - pass.first_access;
      for (uint32_t a = pass.first_access; a < plan.accesses.size(); ++a) {
        PlanAccess& access = plan.accesses[a];
        access.layout = touches[first_object[access.resource] + access.frames_back].back().layout;
      }
    }
  }

  // How an object stands when the frame begins: earlier frames of a history are where the frame before left
  // them, one role younger; everything else arrives with its first barrier.
  State start_of(uint32_t object, uint32_t frames_back) const {
    if (frames_back == 0) return {};
    State state = ends[object - 1];
    state.carried = true;
    return state;
  }

  void find_ends() {
    for (uint32_t r = 0; r < plan.resources.size(); ++r)
      for (uint32_t back = 0; back < plan.resources[r].instance_count; ++back) {
        const uint32_t object = first_object[r] + back;
        State state = start_of(object, back);
        for (const Touch& touch : touches[object]) {
          PlanBarrier unused;
          advance(state, touch, !state.touched || dependency(state, touch, unused));
        }
        ends[object] = state;
      }
  }

  // Source and reason of the first barrier of an object whose old contents do not count.
  std::string arrive(uint32_t resource, PlanBarrier& barrier) const {
    const PlanResource& own = plan.resources[resource];
    if (host_owned(resource)) {
      barrier.from_host = true;
      barrier.why = PlanBarrier::Why::host_before;
      return fmt::format("takes '{}' over from the host", name(resource));
    }
    if (own.instance_count > 1) { // the oldest instance becomes the newest
      const Scope scope = tail(ends[first_object[resource] + own.instance_count - 1]);
      barrier.source_stages = scope.stages;
      barrier.source_access = scope.access;
      barrier.why = PlanBarrier::Why::history;
      return fmt::format("reuses the oldest instance of '{}' for this frame", name(resource));
    }
    // Occupants of the same bytes: those before it in this frame, and all of them in the frame before.
    std::string others;
    const Placement& place = plan.placements[own.first_instance];
    for (const Placement& other : plan.placements) {
      const bool overlap = other.heap == place.heap && other.offset < place.offset + place.size &&
                           place.offset < other.offset + other.size;
      if (!overlap) continue;
      const Scope scope = tail(ends[first_object[other.resource]]);
      barrier.source_stages |= scope.stages;
      barrier.source_access |= scope.access;
      if (other.resource != resource)
        others += fmt::format("{}'{}'", others.empty() ? "" : ", ", name(other.resource));
    }
    barrier.why = others.empty() ? PlanBarrier::Why::first_use : PlanBarrier::Why::alias;
    if (others.empty())
      return fmt::format("first use of '{}', behind its last use in the frame before", name(resource));
    return fmt::format("'{}' takes over memory of {}", name(resource), others);
  }

  std::string explain(const PlanBarrier& barrier, const State& before, uint32_t position) const {
    const std::string& pass = pass_name(position);
    const std::string what = barrier.frames_back == 0
                                 ? fmt::format("'{}'", name(barrier.resource))
                                 : fmt::format("'{}@-{}'", name(barrier.resource), barrier.frames_back);
    const std::string last =
        fmt::format("'{}'{}", pass_name(before.last_pass), before.carried ? " in the frame before" : "");
    switch (barrier.why) {
    case PlanBarrier::Why::write_after_read:
      return fmt::format("'{}' writes over {} once {} has read it", pass, what, last);
    case PlanBarrier::Why::write_after_write:
      return fmt::format("'{}' writes {} after {}", pass, what, last);
    case PlanBarrier::Why::layout:
      return fmt::format("'{}' needs {} in another layout than {}", pass, what, last);
    default:
      return fmt::format("'{}' reads {} as {} left it", pass, what, last);
    }
  }

  void walk(uint32_t resource, uint32_t frames_back) {
    const uint32_t object = first_object[resource] + frames_back;
    State state = start_of(object, frames_back);
    for (const Touch& touch : touches[object]) {
      PlanBarrier barrier;
      barrier.resource = resource;
      barrier.frames_back = frames_back;
      bool waited = true;
      if (!state.touched) {
        barrier.destination_stages = touch.stages;
        barrier.destination_access = touch.access;
        barrier.new_layout = touch.layout;
        std::string reason = arrive(resource, barrier);
        planned.push_back({touch.position, barrier, std::move(reason)});
      } else {
        waited = dependency(state, touch, barrier);
        if (waited) {
          std::string reason = explain(barrier, state, touch.position);
          if (state.carried) barrier.why = PlanBarrier::Why::history;
          planned.push_back({touch.position, barrier, std::move(reason)});
        }
      }
      advance(state, touch, waited);
    }
  }

  // Every slot is handed back in the state the host asked for, also one that no pass touched.
  void hand_back(uint32_t resource) {
    const State& end = ends[first_object[resource]];
    const Scope scope = tail(end);
    PlanBarrier barrier;
    barrier.resource = resource;
    barrier.from_host = !end.touched;
    barrier.to_host = true;
    barrier.source_stages = scope.stages;
    barrier.source_access = scope.access;
    barrier.old_layout = end.layout;
    barrier.why = PlanBarrier::Why::host_after;
    planned.push_back({static_cast<uint32_t>(plan.passes.size()), barrier,
                       fmt::format("hands '{}' back to the host{}", name(resource),
                                   end.touched ? "" : "; no pass touched it")});
  }

  void write_out() {
    std::stable_sort(planned.begin(), planned.end(),
                     [](const Planned& a, const Planned& b) { return a.position < b.position; });
    size_t next = 0;
    const auto batch = [&](uint32_t position, uint32_t& first, uint32_t& count) {
      first = static_cast<uint32_t>(plan.barriers.size());
      for (; next < planned.size() && planned[next].position == position; ++next) {
        c.because(Reason::About::barrier, static_cast<uint32_t>(plan.barriers.size()), planned[next].reason);
        plan.barriers.push_back(planned[next].barrier);
      }
      count = static_cast<uint32_t>(plan.barriers.size()) - first;
    };
    for (uint32_t position = 0; position < plan.passes.size(); ++position)
      batch(position, plan.passes[position].first_barrier, plan.passes[position].barrier_count);
    batch(static_cast<uint32_t>(plan.passes.size()), plan.first_final_barrier, plan.final_barrier_count);
  }

  void describe_histories() {
    for (uint32_t r = 0; r < plan.resources.size(); ++r) {
      const PlanResource& resource = plan.resources[r];
      if (resource.instance_count == 1) continue;
      PlanHistory history;
      history.resource = r;
      history.frames = resource.instance_count - 1;
      history.declaration = c.graph.resources[resource.declared.value].history;
      history.layout_at_start.push_back(Layout::undefined);
      for (uint32_t back = 1; back < resource.instance_count; ++back)
        history.layout_at_start.push_back(ends[first_object[r] + back - 1].layout);
      plan.histories.push_back(std::move(history));
    }
  }
};

} // namespace

void synchronize(CompileContext& c) {
  Synchronizer synchronizer{c};
  synchronizer.collect();
  synchronizer.find_ends();
  for (uint32_t r = 0; r < c.out.plan.resources.size(); ++r) {
    for (uint32_t back = 0; back < c.out.plan.resources[r].instance_count; ++back)
      synchronizer.walk(r, back);
    if (synchronizer.host_owned(r)) synchronizer.hand_back(r);
  }
  synchronizer.write_out();
  synchronizer.describe_histories();
  c.out.plan.graph = c.graph.name;
  c.out.plan.view_width = c.input.view_width;
  c.out.plan.view_height = c.input.view_height;
  c.out.plan.device_profile = c.device.name;
}

} // namespace dermis
