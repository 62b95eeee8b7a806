// In which order the passes run. The order of the file, unless running depth first keeps fewer bytes alive:
// of the passes that one needs, those come first whose own work needs most memory beyond what they leave
// (Sethi and Ullman 1970, with bytes for registers). O((n + e) log n).

#include "framegraph/compile/phases.hpp"
#include "framegraph/model/splitmix.hpp"

#include <algorithm>

namespace dermis {
namespace {

struct Orderer {
  CompileContext& c;
  uint32_t passes = 0;

  // Calls visit(before) for each pass that `pass` waits for, except for readers of what it writes over.
  template <class Visit> void for_each_before(uint32_t pass, Visit visit) const {
    for (uint32_t u = c.first_use[pass]; u < c.first_use[pass + 1]; ++u) {
      const Use& use = c.uses[u];
      if (use.bind_error != Use::BindError::none) continue;
      if (use.read_value != no_value) visit(c.values[use.read_value].producer);
      if (use.write_value == no_value) continue;
      const uint32_t previous = c.values[use.write_value].previous;
      if (previous != no_value) visit(c.values[previous].producer);
    }
    for (const Ordering& ordering : c.graph->passes[pass].after)
      visit(ordering.after);
  }

  // Who reads a value that another pass writes over, sorted by that pass.
  void find_readers() {
    c.readers.clear();
    if (!c.overwrites) return;
    c.candidate.assign(c.values.size(), no_value); // by value: the pass that writes over it
    for (const Value& value : c.values)
      if (value.previous != no_value) c.candidate[value.previous] = value.producer.value;
    for (const Use& use : c.uses) {
      if (use.bind_error != Use::BindError::none || use.read_value == no_value) continue;
      const uint32_t overwriter = c.candidate[use.read_value];
      if (overwriter == no_value || overwriter == use.pass.value) continue;
      if (c.live[overwriter] && c.live[use.pass.value]) c.readers.emplace_back(overwriter, use.pass.value);
    }
    std::sort(c.readers.begin(), c.readers.end());
  }

  // Fills c.before; false if some pass that is on needs one that does not stand before it.
  bool collect() {
    const bool plain = !c.overwrites && !c.ordered && !c.values.empty();
    return plain ? collect_producers() : collect_all();
  }

  // Where passes wait for producers only. One loop over all uses, which does not branch on what it finds.
  bool collect_producers() {
    bool forward = true;
    uint32_t count = 0;
    c.before.resize(c.uses.size() + 1);
    c.first_before.assign(size_t{passes} + 1, 0);
    for (const Use& use : c.uses) {
      const bool reads = (use.bind_error == Use::BindError::none) & (use.read_value != no_value);
      const PassId other = c.values[pick(reads, use.read_value, 0u)].producer;
      const bool waits = (int{reads} & int{other.valid()} & int{other != use.pass}) != 0;
      forward &= !waits | (other < use.pass);
      c.before[count] = other.value;
      count += static_cast<uint32_t>(waits) & c.live[use.pass.value]; // what it reads is alive, too
      c.first_before[use.pass.value + 1] = count;
    }
    c.before.resize(count);
    for (uint32_t pass = 0; pass < passes; ++pass) // those without uses
      c.first_before[pass + 1] = std::max(c.first_before[pass + 1], c.first_before[pass]);
    return forward;
  }

  bool collect_all() {
    bool forward = true;
    size_t reader = 0;
    c.before.clear();
    c.first_before.clear();
    for (uint32_t pass = 0; pass < passes; ++pass) {
      c.first_before.push_back(static_cast<uint32_t>(c.before.size()));
      if (!c.on[pass]) continue;
      for_each_before(pass, [&](PassId other) {
        if (!other.valid() || other.value == pass || !c.on[other.value]) return;
        forward &= other.value < pass;
        if (c.live[pass] && c.live[other.value]) c.before.push_back(other.value);
      });
      for (; reader < c.readers.size() && c.readers[reader].first == pass; ++reader) {
        forward &= c.readers[reader].second < pass;
        c.before.push_back(c.readers[reader].second);
      }
    }
    c.first_before.push_back(static_cast<uint32_t>(c.before.size()));
    return forward;
  }

  void file_order() {
    c.order.clear();
    for (uint32_t pass = 0; pass < passes; ++pass)
      if (c.live[pass]) c.order.push_back(PassId{pass});
  }

  // From where to where each resource is used if the passes run in `sequence`; one more, for what is not.
  template <class Sequence> void find_intervals(const Sequence& sequence, std::vector<Interval>& intervals) {
    const auto nowhere = static_cast<uint32_t>(c.graph->resources.size());
    intervals.assign(size_t{nowhere} + 1, {});
    c.position.resize(passes);
    uint32_t position = 0;
    for (const auto& item : sequence)
      c.position[number(item)] = position++;
    for (const Use& use : c.uses) {
      const bool counts = (use.bind_error == Use::BindError::none) & (c.live[use.pass.value] != 0);
      Interval& interval = intervals[counts ? use.resource.value : nowhere];
      const uint32_t at = c.position[use.pass.value];
      interval.first = std::min(interval.first, at);
      interval.last = std::max(interval.last, at);
    }
  }
  static uint32_t number(PassId pass) { return pass.value; }
  static uint32_t number(uint32_t pass) { return pass; }

  // The most bytes of transients alive at once.
  uint64_t max_alive(const std::vector<Interval>& intervals) {
    c.changes.assign(c.order.size() + 1, 0);
    for (uint32_t r = 0; r < c.transient_bytes.size(); ++r) {
      if (intervals[r].first == no_value) continue;
      const auto bytes = static_cast<int64_t>(c.transient_bytes[r]);
      c.changes[intervals[r].first] += bytes;
      c.changes[intervals[r].last + 1] -= bytes;
    }
    int64_t alive = 0, maximum = 0;
    for (const int64_t change : c.changes)
      maximum = std::max(maximum, alive += change);
    return static_cast<uint64_t>(maximum);
  }

  // As if the passes were a tree: how many bytes each needs while it and all before it run, and how many it
  // leaves. Sorts what each waits for into the order in which it is best done.
  void estimate() {
    c.peak_bytes.assign(passes, 0);
    c.output_bytes.assign(size_t{passes} + 1, 0); // one more, for what no pass writes
    for (const Value& value : c.values) {
      const uint64_t bytes = value.previous == no_value ? c.transient_bytes[value.resource.value] : 0;
      c.output_bytes[std::min(value.producer.value, passes)] += bytes;
    }
    for (const PassId pass : c.order) {
      uint64_t running = 0, peak = 0;
      const auto gain = [&](uint32_t p) { return c.peak_bytes[p] - c.output_bytes[p]; };
      const uint32_t first = c.first_before[pass.value], end = c.first_before[pass.value + 1];
      for (uint32_t i = first + 1; i < end; ++i) // few
        for (uint32_t at = i; at > first && gain(c.before[at]) > gain(c.before[at - 1]); --at)
          std::swap(c.before[at], c.before[at - 1]);
      for (uint32_t i = first; i < end; ++i) {
        peak = std::max(peak, running + c.peak_bytes[c.before[i]]);
        running += c.output_bytes[c.before[i]];
      }
      c.peak_bytes[pass.value] = std::max(peak, running + c.output_bytes[pass.value]);
    }
  }

  // Depth first from the passes that none waits for, in file order, into c.candidate.
  void depth_first() {
    std::vector<uint8_t>& state = c.seen; // 1: somebody waits for it; 2: on the stack or done
    state.assign(passes, 0);
    for (const uint32_t before : c.before)
      state[before] = 1;
    c.candidate.clear();
    c.stack.clear();
    for (const PassId root : c.order) {
      if (state[root.value] != 0) continue;
      state[root.value] = 2;
      c.stack.push_back(root.value);
      c.uses_cursor.push_back(c.first_before[root.value]);
      while (!c.stack.empty()) {
        const uint32_t pass = c.stack.back();
        uint32_t& at = c.uses_cursor.back();
        if (at == c.first_before[pass + 1]) {
          c.candidate.push_back(pass);
          c.stack.pop_back();
          c.uses_cursor.pop_back();
          continue;
        }
        const uint32_t next = c.before[at++];
        if (state[next] == 2) continue;
        state[next] = 2;
        c.stack.push_back(next);
        c.uses_cursor.push_back(c.first_before[next]);
      }
    }
  }

  void record_reason(Reason::ReasonKind why, uint64_t bytes = 0, uint64_t other_bytes = 0) {
    constexpr uint64_t kib = 1024, maximum = no_value;
    c.record_reason(Reason::About::order, 0, why, static_cast<uint32_t>(std::min(bytes / kib, maximum)),
                    static_cast<uint32_t>(std::min(other_bytes / kib, maximum)));
  }

  void save_memory() {
    estimate();
    depth_first();
    find_intervals(c.candidate, c.other_intervals);
    const uint64_t file = max_alive(c.intervals), depth = max_alive(c.other_intervals);
    if (depth >= file) return record_reason(Reason::ReasonKind::order_of_file, file, depth);
    record_reason(Reason::ReasonKind::depth_first, depth, file);
    c.intervals.swap(c.other_intervals);
    c.order.clear();
    for (const uint32_t pass : c.candidate)
      c.order.push_back(PassId{pass});
  }

  // Any legal order: of the passes that wait for nothing more, one drawn at random.
  void shuffle() {
    SplitMix64 random{c.input->order_seed};
    std::vector<std::vector<uint32_t>> followers(passes);
    std::vector<uint32_t> waits(passes, 0), ready;
    for (const PassId pass : c.order)
      for (uint32_t i = c.first_before[pass.value]; i < c.first_before[pass.value + 1]; ++i) {
        followers[c.before[i]].push_back(pass.value);
        ++waits[pass.value];
      }
    for (const PassId pass : c.order)
      if (waits[pass.value] == 0) ready.push_back(pass.value);
    c.order.clear();
    while (!ready.empty()) {
      std::swap(ready[random.below(ready.size())], ready.back());
      const uint32_t pass = ready.back();
      ready.pop_back();
      c.order.push_back(PassId{pass});
      for (const uint32_t next : followers[pass])
        if (--waits[next] == 0) ready.push_back(next);
    }
  }
};

} // namespace

void order(CompileContext& c) {
  Orderer orderer{c, static_cast<uint32_t>(c.graph->passes.size())};
  orderer.find_readers();
  if (orderer.collect()) {
    orderer.file_order();
  } else {
    const uint32_t errors = c.diagnostics->count(Severity::error);
    sort_backward_graph(c);
    if (c.diagnostics->count(Severity::error) != errors) return;
  }
  if (c.input->order == PassOrder::program) orderer.record_reason(Reason::ReasonKind::program_order);
  if (c.input->order == PassOrder::random) {
    orderer.record_reason(Reason::ReasonKind::random_order);
    orderer.shuffle();
  }
  orderer.find_intervals(c.order, c.intervals);
  if (c.input->order == PassOrder::memory) orderer.save_memory();
}

} // namespace dermis
