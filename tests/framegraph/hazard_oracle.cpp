#include "tests/framegraph/hazard_oracle.hpp"

#include "tests/framegraph/hazard_operation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace dermis::testing {
namespace {

struct Oracle {
  const Plan& plan;
  std::vector<Operation> all;
  std::vector<size_t> next_write =
      {}; // By operation: the next operation of another step that writes the same subresource.
  // By resource: mips and layers that accesses and barriers name.
  std::map<uint32_t, std::set<std::array<uint32_t, 2>>> used_parts = {};

  uint32_t instance(uint32_t resource, uint32_t frames_back, uint32_t frame) const {
    return instance_in_frame(plan, resource, frames_back, frame);
  }
  bool host(uint32_t resource) const { return is_host_resource(plan, resource); }
  bool image(const Operation& o) const {
    return plan.resources[o.resource].type == ResourceType::image;
  }
  bool overlap(const Operation& a, const Operation& b) const {
    if (a.heap != b.heap || std::max(a.begin, b.begin) >= std::min(a.end, b.end)) return false;
    return !same_instance(a, b) || same_subresource(a, b);
  }
  // Returns whether the operation covers this byte of the heap, or the subresource of `other`.
  bool reaches(const Operation& o, const Operation& other, uint64_t byte) const {
    return overlap(o, other) && (same_instance(o, other) || (o.begin <= byte && byte < o.end));
  }
  // Returns one byte of each piece of the common range of two operations, cut where other
  // placements begin or end.
  std::vector<uint64_t> common_bytes(const Operation& a, const Operation& b) const {
    if (host(a.resource)) return {0};
    const uint64_t begin = std::max(a.begin, b.begin), end = std::min(a.end, b.end);
    std::vector<uint64_t> bytes{begin};
    for (const Placement& other : plan.placements)
      for (const uint64_t border : {other.offset, other.offset + other.size})
        if (other.heap == a.heap && border > begin && border < end) bytes.push_back(border);
    std::sort(bytes.begin(), bytes.end());
    bytes.erase(std::unique(bytes.begin(), bytes.end()), bytes.end());
    return bytes;
  }
  // Returns whether the operation is a barrier that changes the contents: a change of layout or
  // owner.
  bool transition(const Operation& o) const {
    return is_barrier(o) && (o.barrier->from_host || o.barrier->to_host ||
                             o.barrier->transfer != PlanBarrier::Transfer::none ||
                             (image(o) && o.barrier->old_layout != o.barrier->new_layout));
  }
  bool acts(const Operation& o) const { return accesses(o) || transition(o); }
  bool writes(const Operation& o) const { return written(o) != 0 || transition(o); }

  // --- Dependencies that the barriers between two operations establish

  struct Path {
    Stage ordered[2] = {0, 0}; // By queue: stages that wait for the first operation.
    // By queue: the first step from which stages wait.
    uint32_t since[2] = {no_instance, no_instance};
    bool available = false;
    Stage after_available[2] = {0, 0}; // By queue: stages that wait until it is available.
    bool visible = false;              // Visible to the reads of the second operation.
    bool visible_to_write = false;
  };

  static void show(Path& p, const Operation& second, Queue queue, Stage stages, Access access) {
    if (queue != second.queue || !p.available || !accesses(second) ||
        (second.access->stages & ~stages) != 0)
      return;
    p.visible |= (read(second) & ~access) == 0;
    p.visible_to_write |= (written(second) & ~access) == 0;
  }

  static void reach(Path& p, const Operation& by, Stage stages) {
    p.ordered[queue_index(by.queue)] |= stages;
    if (stages != 0)
      p.since[queue_index(by.queue)] = std::min(p.since[queue_index(by.queue)], by.step);
  }

  static void make_available(Path& p, const Operation& by, Stage stages) {
    p.available = true;
    p.after_available[queue_index(by.queue)] |= stages;
  }

  Path path(size_t first, size_t second, uint64_t byte) const {
    const Operation& a = all[first];
    Path p;
    if (is_barrier(a)) {
      reach(p, a, a.barrier->destination_stages);
      make_available(p, a, a.barrier->destination_stages);
      show(p, all[second], a.queue, a.barrier->destination_stages, a.barrier->destination_access);
    }
    for (size_t k = first + 1; k < second; ++k) {
      const Operation& o = all[k];
      if (o.what == Operation::What::wait) {
        const size_t other = 1 - queue_index(o.queue);
        const bool done = queue_index(a.queue) == other && a.step <= o.until;
        if (!done && p.since[other] > o.until) continue;
        reach(p, o, ~uint64_t{0});
        make_available(p, o, ~uint64_t{0});
        show(p, all[second], o.queue, ~uint64_t{0}, ~uint64_t{0});
        continue;
      }
      if (!is_barrier(o) || o.barrier->from_host || !reaches(o, a, byte)) continue;
      const PlanBarrier& b = *o.barrier;
      const bool directly =
          accesses(a) && a.queue == o.queue && (a.access->stages & ~b.source_stages) == 0;
      if (!directly && (p.ordered[queue_index(o.queue)] & b.source_stages) == 0) continue;
      reach(p, o, b.destination_stages);
      // A barrier that makes nothing available only helps after one that did.
      if (!(directly && (written(a) & ~b.source_access) == 0) &&
          (p.after_available[queue_index(o.queue)] & b.source_stages) == 0)
        continue;
      make_available(p, o, b.destination_stages);
      show(p, all[second], o.queue, b.destination_stages, b.destination_access);
    }
    return p;
  }

  // Returns whether an operation between the two overwrites the result of `first`. The overwriting
  // operation waits for `first`, and `second` waits for the overwriting operation.
  bool replaced(size_t first, size_t second) const {
    const size_t k = next_write[first];
    return k < second && all[k].step != all[second].step;
  }

  void find_next_writes_and_used_parts() {
    next_write.assign(all.size(), all.size());
    std::map<std::array<uint32_t, 4>, size_t> nearest; // By subresource: the nearest later write.
    for (size_t i = all.size(); i-- > 0;) {
      const Operation& o = all[i];
      if (o.what == Operation::What::wait) continue;
      if (accesses(o) || is_barrier(o)) used_parts[o.resource].insert({o.mip, o.layer});
      size_t& first =
          nearest.try_emplace({o.resource, o.instance, o.mip, o.layer}, all.size()).first->second;
      if (first < all.size()) next_write[i] = all[first].step != o.step ? first : next_write[first];
      if (writes(o)) first = i;
    }
  }

  bool read_since(size_t first, size_t second) const {
    for (size_t k = first + 1; k < second; ++k)
      if (accesses(all[k]) && all[k].access->when == ReadWhen::always &&
          all[k].step != all[second].step && same_subresource(all[k], all[first]))
        return true;
    return false;
  }

  // Returns whether another instance has overwritten this byte between the two operations: every
  // part of it that the plan uses was written. Then the result of `first` is not the last write.
  bool overwritten(size_t first, size_t second, uint64_t byte) const {
    std::map<std::array<uint32_t, 2>, std::set<std::array<uint32_t, 2>>> parts; // By instance.
    for (size_t k = first + 1; k < second; ++k) {
      const Operation& o = all[k];
      const bool other =
          o.step != all[first].step && o.step != all[second].step && !same_instance(o, all[first]);
      if (other && writes(o) && reaches(o, all[first], byte))
        parts[{o.resource, o.instance}].insert({o.mip, o.layer});
    }
    return std::any_of(parts.begin(), parts.end(), [&](const auto& instance) {
      return instance.second.size() == used_parts.at(instance.first[0]).size();
    });
  }

  // --- Checks

  std::string pair(size_t first, size_t second) const { // At least one of both writes.
    const Operation &a = all[first], &b = all[second];
    if (a.step == b.step || !overlap(a, b)) return "";
    if (is_barrier(b) && b.barrier->from_host) return ""; // The host synchronizes its own work.
    if (replaced(first, second)) return "";
    for (const uint64_t byte : common_bytes(a, b))
      if (std::string wrong = pair(first, second, byte); !wrong.empty()) return wrong;
    return "";
  }

  std::string pair(size_t first, size_t second, uint64_t byte) const {
    const Operation &a = all[first], &b = all[second];
    const Path p = path(first, second, byte);
    const Stage before = p.ordered[queue_index(b.queue)];
    const bool directly = is_barrier(b) && accesses(a) && a.queue == b.queue &&
                          (a.access->stages & ~b.barrier->source_stages) == 0;
    const bool ordered = accesses(b) ? (b.access->stages & ~before) == 0
                                     : directly || (before & b.barrier->source_stages) != 0;
    if (!ordered) return "is not ordered behind an earlier operation";
    const bool made_available =
        p.available || (directly && (written(a) & ~b.barrier->source_access) == 0);
    if (writes(a) && writes(b) && !made_available)
      return "comes before an earlier write is available";
    if (writes(a) && read(b) != 0 && same_subresource(a, b) && !p.visible)
      return "does not see the last write";
    // Two writes need availability. The last write must also be visible, unless it was read since.
    if (writes(a) && written(b) != 0 && !p.visible_to_write && !read_since(first, second) &&
        !overwritten(first, second, byte))
      return "is written where the last write is not visible";
    return "";
  }

  const PlanHistory* history_of(uint32_t resource) const {
    for (const PlanHistory& history : plan.histories)
      if (history.resource == resource) return &history;
    return nullptr;
  }
  // The instance of this frame holds the oldest frame until it is written.
  bool keeps_oldest(uint32_t resource) const {
    const PlanHistory* history = history_of(resource);
    return history && plan.resources[resource].instance_count == history->frames;
  }

  // Returns whether another access of the same pass writes the bytes of operation `at`.
  bool raced(size_t at) const {
    const Operation& o = all[at];
    const bool own = written(o) == 0 && o.access->own_texels;
    size_t k = at;
    for (; k > 0 && all[k - 1].step == o.step; --k) {
    }
    for (; k < all.size() && all[k].step == o.step; ++k)
      if (all[k].access != o.access && written(all[k]) != 0 && overlap(all[k], o) &&
          !(own && same_subresource(all[k], o)))
        return true;
    return false;
  }

  // Returns whether operation `second` reads the requested frame.
  bool right_frame(size_t second) const {
    const Operation& o = all[second];
    if (!history_of(o.resource)) return true;
    for (size_t k = second; k-- > 0;)
      if (all[k].step != o.step && same_subresource(all[k], o) && written(all[k]) != 0)
        return all[k].frame + o.access->frames_back == o.frame + all[k].access->frames_back;
    const uint32_t first_frames = o.access->frames_back;
    return o.frame < first_frames; // The executor clears histories before their first frame.
  }

  // Returns whether the contents that operation `second` reads are defined.
  bool defined(size_t second) const {
    for (size_t k = second; k-- > 0;) {
      const Operation& o = all[k];
      if (o.what == Operation::What::wait || o.step == all[second].step || !overlap(o, all[second]))
        continue;
      const bool own = same_subresource(o, all[second]);
      if (o.what == Operation::What::frame_begins) {
        if (own && !keeps_oldest(o.resource))
          return host(o.resource) && plan.resources[o.resource].origin == Origin::imported;
      } else if (!own) {
        if (written(o) != 0 || (transition(o) && !o.barrier->from_host)) return false;
      } else if (written(o) != 0) {
        return true;
      } else if (is_barrier(o) && !o.barrier->from_host && image(o) &&
                 o.barrier->old_layout == Layout::undefined) {
        return false;
      }
    }
    // The executor clears histories before their first frame.
    return history_of(all[second].resource) != nullptr;
  }

  // Returns the layout of a subresource just before operation `at`.
  Layout layout(const Operation& subresource, size_t at) const {
    for (size_t k = at; k-- > 0;)
      if (transition(all[k]) && all[k].barrier->transfer != PlanBarrier::Transfer::release &&
          same_subresource(all[k], subresource))
        return all[k].barrier->new_layout;
    for (const PlanHistory& history : plan.histories)
      for (uint32_t back = 1; history.resource == subresource.resource && back <= history.frames;
           ++back)
        if (instance(subresource.resource, back, 0) == subresource.instance)
          return kept_layout(history, subresource, back);
    return Layout::undefined;
  }

  // Returns the layout that the plan states for this mip and layer at the start of a frame.
  Layout kept_layout(const PlanHistory& history, const Operation& subresource,
                     uint32_t back) const {
    for (uint32_t r = 0; r < history.range_count; ++r) {
      const SubresourceRange& range = plan.history_ranges[history.first_range + r];
      if (subresource.mip >= range.first_mip && subresource.mip - range.first_mip < range.mips &&
          subresource.layer >= range.first_layer &&
          subresource.layer - range.first_layer < range.layers)
        return plan.history_layouts[history.first_layout + back * history.range_count + r];
    }
    return Layout::undefined;
  }

  bool with_host(size_t at) const {
    for (size_t k = at; k-- > 0;)
      if (is_barrier(all[k]) && same_subresource(all[k], all[at]) &&
          (all[k].barrier->from_host || all[k].barrier->to_host))
        return all[k].barrier->to_host;
    return true;
  }

  // Returns whether the resource was released to the host in the frame that ends before operation
  // `at`.
  bool handed_back(size_t at) const {
    if (all[at].frame == 0) return true;
    for (size_t k = at; k-- > 0 && all[k].frame + 1 >= all[at].frame;)
      if (is_barrier(all[k]) && same_subresource(all[k], all[at])) return all[k].barrier->to_host;
    return false;
  }

  struct Owner {
    Queue queue = Queue::main;
    const PlanBarrier* released = nullptr;
  };
  // Returns the queue that owns a subresource just before operation `at`, and its pending release.
  Owner owner(size_t at) const {
    for (size_t k = at; k-- > 0;) {
      const Operation& o = all[k];
      if (!same_subresource(o, all[at])) continue;
      if (accesses(o) && written(o) != 0) return {o.queue, nullptr};
      if (!is_barrier(o) || o.barrier->from_host) continue;
      if (o.barrier->transfer == PlanBarrier::Transfer::release) return {o.queue, o.barrier};
      const bool discards = image(o) && o.barrier->old_layout == Layout::undefined;
      if (discards || o.barrier->transfer == PlanBarrier::Transfer::acquire)
        return {o.queue, nullptr};
    }
    return {};
  }

  std::string on_queue(size_t at) const {
    const Operation& o = all[at];
    const Owner own = owner(at);
    if (accesses(o)) {
      // A write without a read discards earlier contents.
      const bool fresh = !image(o) && read(o) == 0;
      return own.released || (own.queue != o.queue && !fresh) ? "belongs to the other queue" : "";
    }
    if (!is_barrier(o)) return "";
    const PlanBarrier& b = *o.barrier;
    if ((b.from_host || b.to_host) && o.queue != Queue::main)
      return "is the host's on the async queue";
    if (b.from_host) return "";
    switch (b.transfer) {
    case PlanBarrier::Transfer::none: {
      const bool discards = image(o) && b.old_layout == Layout::undefined;
      const bool free = discards || (!image(o) && !own.released);
      return !free && (own.released || own.queue != o.queue) ? "belongs to the other queue" : "";
    }
    case PlanBarrier::Transfer::release:
      return own.released || own.queue != o.queue ? "is not this queue's to release" : "";
    case PlanBarrier::Transfer::acquire:
      return !own.released || own.queue == o.queue || own.released->old_layout != b.old_layout ||
                     own.released->new_layout != b.new_layout
                 ? "is not released like that"
                 : "";
    }
    return "";
  }

  std::string check_operation(size_t at) const {
    const Operation& o = all[at];
    if (o.what == Operation::What::wait) return "";
    if (const std::string wrong = on_queue(at); !wrong.empty()) return wrong;
    const bool owned = host(o.resource) && with_host(at);
    if (accesses(o)) {
      if (owned) return "is the host's";
      if (written(o) != 0 && o.access->frames_back > 0) return "writes an earlier frame";
      if (image(o) && layout(o, at) != o.access->layout) return "is in another layout";
      if (read(o) != 0 && !defined(at)) return "is read undefined";
      if (read(o) != 0 && !right_frame(at)) return "reads another frame";
      if (raced(at)) return "touches what its pass writes";
      if (o.access->when == ReadWhen::history_valid && o.access->frames_back == 0)
        return "depends on the validity of this frame";
      if (host(o.resource)) return "";
      const Placement& memory = plan.placements[plan.resources[o.resource].first_instance];
      const auto position = static_cast<uint32_t>(
          std::find_if(plan.passes.begin(), plan.passes.end(),
                       [&](const PlanPass& pass) {
                         const auto index = static_cast<uint32_t>(o.access - plan.accesses.data());
                         return index >= pass.first_access &&
                                index - pass.first_access < pass.access_count;
                       }) -
          plan.passes.begin());
      return position < memory.first_use || position > memory.last_use
                 ? "has no memory at that time"
                 : "";
    }
    if (o.what == Operation::What::frame_begins) {
      for (const PlanHistory& history : plan.histories)
        for (uint32_t back = 1; history.resource == o.resource && back <= history.frames; ++back) {
          Operation past = o;
          past.instance = instance(o.resource, back, o.frame);
          if (layout(past, at) != kept_layout(history, o, back))
            return "starts a frame in another layout";
        }
      return host(o.resource) && !handed_back(at) ? "is not handed back" : "";
    }
    if (o.barrier->from_host) return owned ? "" : "is taken over twice";
    if (o.barrier->to_host && !host(o.resource)) return "is not the host's";
    if (owned) return "has a barrier while it is the host's";
    if (!image(o)) return "";
    if (o.barrier->old_layout != Layout::undefined && o.barrier->old_layout != layout(o, at))
      return "leaves a layout that it is not in";
    const bool nowhere =
        o.barrier->old_layout == Layout::undefined && o.barrier->new_layout == Layout::undefined;
    return nowhere && !o.barrier->to_host ? "is moved to no layout" : "";
  }

  std::string live_together() const {
    for (size_t i = 0; i < plan.placements.size(); ++i)
      for (size_t k = 0; k < i; ++k) {
        const Placement &m = plan.placements[i], &n = plan.placements[k];
        const bool disjoint =
            m.persistent != n.persistent || // A history alias: the content checks cover it.
            (!m.persistent && !n.persistent &&
             (m.last_use < n.first_use || n.last_use < m.first_use));
        const bool bytes = m.heap == n.heap && std::max(m.offset, n.offset) <
                                                   std::min(m.offset + m.size, n.offset + n.size);
        if (bytes && !disjoint) return fmt::format("placements {} and {} share live memory", k, i);
      }
    return "";
  }
};

} // namespace

std::string first_hazard(const Plan& plan) {
  if (const std::string wrong = Oracle{plan, {}}.live_together(); !wrong.empty()) return wrong;
  uint32_t frames = 3;
  for (const PlanHistory& history : plan.histories)
    frames = std::max(frames, history.frames + 3);
  // Instances need enough frames for each to become the oldest.
  for (const PlanResource& resource : plan.resources)
    frames = std::max(frames, 2 * resource.instance_count + 1);
  // The beginning of the last frame checks how the previous frame ended.
  UnrolledPlan unrolled = unroll(plan, frames + 1);
  if (!unrolled.misplaced.empty()) return unrolled.misplaced;
  Oracle oracle{plan, std::move(unrolled.operations)};
  oracle.find_next_writes_and_used_parts();
  std::vector<size_t> acting, writing; // Operations before b.
  for (size_t b = 0; b < oracle.all.size() && oracle.all[b].frame <= frames; ++b) {
    const Operation& o = oracle.all[b];
    if (o.frame == frames && o.what != Operation::What::frame_begins) break;
    std::string wrong = oracle.check_operation(b);
    if (oracle.acts(o)) {
      const std::vector<size_t>& earlier = oracle.writes(o) ? acting : writing;
      for (size_t i = 0; i < earlier.size() && wrong.empty(); ++i)
        wrong = oracle.pair(earlier[i], b);
      acting.push_back(b);
      if (oracle.writes(o)) writing.push_back(b);
    }
    if (!wrong.empty())
      return fmt::format("frame {}, step {}: resource {}.{} {}", o.frame, o.step, o.resource,
                         o.instance, wrong);
  }
  return "";
}

} // namespace dermis::testing
