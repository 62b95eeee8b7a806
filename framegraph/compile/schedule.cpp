// Orders the live passes. The order of the file is kept unless a depth-first order has fewer bytes
// live at once. Depth first, a pass's producers run in descending order of (peak bytes - output
// bytes), after Sethi and Ullman 1970 with bytes in place of registers. O((n + e) log n).

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/phases.hpp"
#include "framegraph/model/splitmix.hpp"

#include <algorithm>

namespace dermis {
namespace {

struct Scheduler {
  const CompileInput& in;
  const Graph& graph;
  const Activation& active;
  const Versions& versions;
  const LiveSet& live;
  const ResourceMemory& memory;
  Report& report;
  ScheduleScratch& scratch;
  Schedule& schedule = scratch.result;
  uint32_t passes = static_cast<uint32_t>(graph.passes.size());

  // Calls visit(before) for each pass that `pass` depends on, except the readers of versions it
  // overwrites.
  template <class Visit> void for_each_before(uint32_t pass, Visit visit) const {
    for (const Use& use : versions.uses_of(pass)) {
      if (use.bind_error != Use::BindError::none) continue;
      if (use.read_version != invalid_index) visit(versions[use.read_version].producer);
      if (use.write_version == invalid_index) continue;
      const uint32_t previous = versions[use.write_version].previous;
      if (previous != invalid_index) visit(versions[previous].producer);
    }
    for (const Ordering& ordering : graph.passes[pass].after)
      visit(ordering.after);
  }

  // Finds the readers of each version that another pass overwrites, sorted by that pass.
  void find_readers() {
    scratch.readers.clear();
    if (!versions.overwrites) return;
    scratch.overwriter.assign(versions.list.size(), invalid_index);
    for (const Version& version : versions.list)
      if (version.previous != invalid_index)
        scratch.overwriter[version.previous] = version.producer.value;
    for (const Use& use : versions.uses) {
      if (use.bind_error != Use::BindError::none || use.read_version == invalid_index) continue;
      const uint32_t overwriter = scratch.overwriter[use.read_version];
      if (overwriter == invalid_index || overwriter == use.pass.value) continue;
      if (live.passes[overwriter] && live.passes[use.pass.value])
        scratch.readers.emplace_back(overwriter, use.pass.value);
    }
    std::sort(scratch.readers.begin(), scratch.readers.end());
  }

  // Collects dependencies; returns false if some pass that is on depends on a pass located after
  // it.
  bool collect_dependencies() {
    const bool plain = !versions.overwrites && !active.ordered && !versions.list.empty();
    return plain ? collect_producers() : collect_all_dependencies();
  }

  // For graphs in which passes depend on producers only. One loop over all uses, without
  // unpredictable branches.
  bool collect_producers() {
    bool forward = true;
    uint32_t count = 0;
    scratch.before.resize(versions.uses.size() + 1);
    scratch.first_before.assign(size_t{passes} + 1, 0);
    for (const Use& use : versions.uses) {
      const bool reads =
          (use.bind_error == Use::BindError::none) & (use.read_version != invalid_index);
      const PassId other = versions[select(reads, use.read_version, 0u)].producer;
      const bool waits = (int{reads} & int{other.valid()} & int{other != use.pass}) != 0;
      forward &= !waits | (other < use.pass);
      scratch.before[count] = other.value;
      count +=
          static_cast<uint32_t>(waits) & live.passes[use.pass.value]; // the producer is live, too
      scratch.first_before[use.pass.value + 1] = count;
    }
    scratch.before.resize(count);
    for (uint32_t pass = 0; pass < passes; ++pass) // passes without uses
      scratch.first_before[pass + 1] =
          std::max(scratch.first_before[pass + 1], scratch.first_before[pass]);
    return forward;
  }

  bool collect_all_dependencies() {
    bool forward = true;
    size_t reader = 0;
    scratch.before.clear();
    scratch.first_before.clear();
    for (uint32_t pass = 0; pass < passes; ++pass) {
      scratch.first_before.push_back(static_cast<uint32_t>(scratch.before.size()));
      if (!active.on[pass]) continue;
      for_each_before(pass, [&](PassId other) {
        if (!other.valid() || other.value == pass || !active.on[other.value]) return;
        forward &= other.value < pass;
        if (live.passes[pass] && live.passes[other.value]) scratch.before.push_back(other.value);
      });
      for (; reader < scratch.readers.size() && scratch.readers[reader].first == pass; ++reader) {
        forward &= scratch.readers[reader].second < pass;
        scratch.before.push_back(scratch.readers[reader].second);
      }
    }
    scratch.first_before.push_back(static_cast<uint32_t>(scratch.before.size()));
    return forward;
  }

  void keep_file_order() {
    schedule.order.clear();
    for (uint32_t pass = 0; pass < passes; ++pass)
      if (live.passes[pass]) schedule.order.push_back(PassId{pass});
  }

  // Computes the lifetime of each resource if the passes run in `sequence`. The additional last
  // entry collects uses that do not count, which avoids a branch.
  template <class Sequence>
  void find_lifetimes(const Sequence& sequence, std::vector<Interval>& lifetimes) {
    const auto nowhere = static_cast<uint32_t>(graph.resources.size());
    lifetimes.assign(size_t{nowhere} + 1, {});
    scratch.position.resize(passes);
    uint32_t position = 0;
    for (const auto& item : sequence)
      scratch.position[number(item)] = position++;
    for (const Use& use : versions.uses) {
      const bool counts =
          (use.bind_error == Use::BindError::none) & (live.passes[use.pass.value] != 0);
      Interval& interval = lifetimes[counts ? use.resource.value : nowhere];
      const uint32_t at = scratch.position[use.pass.value];
      interval.first = std::min(interval.first, at);
      interval.last = std::max(interval.last, at);
    }
  }
  static uint32_t number(PassId pass) { return pass.value; }
  static uint32_t number(uint32_t pass) { return pass; }

  // Returns the maximum of transient bytes live at once.
  uint64_t max_live_bytes(const std::vector<Interval>& lifetimes) {
    scratch.changes.assign(schedule.order.size() + 1, 0);
    for (uint32_t r = 0; r < memory.transient_bytes.size(); ++r) {
      if (lifetimes[r].first == invalid_index) continue;
      const auto bytes = static_cast<int64_t>(memory.transient_bytes[r]);
      scratch.changes[lifetimes[r].first] += bytes;
      scratch.changes[lifetimes[r].last + 1] -= bytes;
    }
    int64_t bytes = 0, maximum = 0;
    for (const int64_t change : scratch.changes)
      maximum = std::max(maximum, bytes += change);
    return static_cast<uint64_t>(maximum);
  }

  // Estimates peak and output bytes of each pass as if the dependencies were a tree, and sorts each
  // pass's dependencies into the order that needs the least memory.
  void estimate_memory() {
    scratch.peak_bytes.assign(passes, 0);
    scratch.output_bytes.assign(size_t{passes} + 1, 0); // the last: versions without a producer
    for (const Version& version : versions.list) {
      const bool first = version.previous == invalid_index;
      const uint64_t bytes = first ? memory.transient_bytes[version.resource.value] : 0;
      scratch.output_bytes[std::min(version.producer.value, passes)] += bytes;
    }
    for (const PassId pass : schedule.order) {
      uint64_t running = 0, peak = 0;
      const auto gain = [&](uint32_t p) { return scratch.peak_bytes[p] - scratch.output_bytes[p]; };
      const uint32_t first = scratch.first_before[pass.value],
                     end = scratch.first_before[pass.value + 1];
      for (uint32_t i = first + 1; i < end; ++i) // few: insertion sort
        for (uint32_t at = i; at > first && gain(scratch.before[at]) > gain(scratch.before[at - 1]);
             --at)
          std::swap(scratch.before[at], scratch.before[at - 1]);
      for (uint32_t i = first; i < end; ++i) {
        peak = std::max(peak, running + scratch.peak_bytes[scratch.before[i]]);
        running += scratch.output_bytes[scratch.before[i]];
      }
      scratch.peak_bytes[pass.value] = std::max(peak, running + scratch.output_bytes[pass.value]);
    }
  }

  // Traverses depth first from the passes that no pass depends on, in file order.
  void find_depth_first_order() {
    std::vector<uint8_t>& state =
        scratch.visited; // 1: some pass depends on it; 2: on the stack or done
    state.assign(passes, 0);
    for (const uint32_t before : scratch.before)
      state[before] = 1;
    scratch.depth_first.clear();
    scratch.stack.clear();
    for (const PassId root : schedule.order) {
      if (state[root.value] != 0) continue;
      state[root.value] = 2;
      scratch.stack.push_back(root.value);
      scratch.cursors.push_back(scratch.first_before[root.value]);
      while (!scratch.stack.empty()) {
        const uint32_t pass = scratch.stack.back();
        uint32_t& at = scratch.cursors.back();
        if (at == scratch.first_before[pass + 1]) {
          scratch.depth_first.push_back(pass);
          scratch.stack.pop_back();
          scratch.cursors.pop_back();
          continue;
        }
        const uint32_t next = scratch.before[at++];
        if (state[next] == 2) continue;
        state[next] = 2;
        scratch.stack.push_back(next);
        scratch.cursors.push_back(scratch.first_before[next]);
      }
    }
  }

  void record_reason(Reason::ReasonKind why, uint64_t bytes = 0, uint64_t other_bytes = 0) {
    constexpr uint64_t kib = 1024, maximum = invalid_index;
    report.record_reason(Reason::About::order, 0, why,
                         static_cast<uint32_t>(std::min(bytes / kib, maximum)),
                         static_cast<uint32_t>(std::min(other_bytes / kib, maximum)));
  }

  // Takes the depth-first order if fewer bytes are live at once.
  void save_memory() {
    estimate_memory();
    find_depth_first_order();
    find_lifetimes(scratch.depth_first, scratch.lifetimes);
    const uint64_t file = max_live_bytes(schedule.lifetimes),
                   depth = max_live_bytes(scratch.lifetimes);
    if (depth >= file) return record_reason(Reason::ReasonKind::order_of_file, file, depth);
    record_reason(Reason::ReasonKind::depth_first, depth, file);
    schedule.lifetimes.swap(scratch.lifetimes);
    schedule.order.clear();
    for (const uint32_t pass : scratch.depth_first)
      schedule.order.push_back(PassId{pass});
  }

  // Any legal order: repeatedly runs a random pass among those whose dependencies are done.
  void shuffle() {
    SplitMix64 random{in.order_seed};
    std::vector<std::vector<uint32_t>> followers(passes);
    std::vector<uint32_t> waits(passes, 0), ready;
    for (const PassId pass : schedule.order)
      for (uint32_t i = scratch.first_before[pass.value]; i < scratch.first_before[pass.value + 1];
           ++i) {
        followers[scratch.before[i]].push_back(pass.value);
        ++waits[pass.value];
      }
    for (const PassId pass : schedule.order)
      if (waits[pass.value] == 0) ready.push_back(pass.value);
    schedule.order.clear();
    while (!ready.empty()) {
      std::swap(ready[random.below(ready.size())], ready.back());
      const uint32_t pass = ready.back();
      ready.pop_back();
      schedule.order.push_back(PassId{pass});
      for (const uint32_t next : followers[pass])
        if (--waits[next] == 0) ready.push_back(next);
    }
  }
};

} // namespace

const Schedule& schedule_passes(const CompileInput& in, const Activation& active,
                                const Versions& versions, const LiveSet& live,
                                const ResourceMemory& memory, Report& report,
                                ScheduleScratch& scratch) {
  Schedule& schedule = scratch.result;
  Scheduler scheduler{in, *in.graph, active, versions, live, memory, report, scratch};
  scheduler.find_readers();
  if (scheduler.collect_dependencies()) {
    scheduler.keep_file_order();
  } else {
    schedule.order = sort_backward_graph(*in.graph, active, versions, live, report);
    if (report.failed()) return schedule;
  }
  if (in.order == PassOrder::program) scheduler.record_reason(Reason::ReasonKind::program_order);
  if (in.order == PassOrder::random) {
    scheduler.record_reason(Reason::ReasonKind::random_order);
    scheduler.shuffle();
  }
  scheduler.find_lifetimes(schedule.order, schedule.lifetimes);
  if (in.order == PassOrder::memory) scheduler.save_memory();
  return schedule;
}

} // namespace dermis
