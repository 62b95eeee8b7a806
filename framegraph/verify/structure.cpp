#include "framegraph/verify/structure.hpp"

#include "framegraph/text/limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <tuple>
#include <utility>

namespace dermis {
namespace {

constexpr uint32_t max_mips = 32; // enough for images with 32-bit sides

struct Checker {
  const Plan& plan;
  std::vector<std::string> violations;
  // by resource: number of earlier frames that its history keeps
  std::vector<uint32_t> deepest = {};

  void find_histories() {
    deepest.assign(plan.resources.size(), 0);
    for (const PlanHistory& history : plan.histories)
      if (history.resource < deepest.size()) deepest[history.resource] = history.frames;
  }

  void expect(bool holds, const char* what, size_t index) {
    if (!holds && violations.size() < max_violations)
      violations.push_back(fmt::format("{} (index {})", what, index));
  }

  static bool range_in(uint64_t first, uint64_t count, size_t size) {
    return first + count <= size;
  }

  bool object_exists(uint32_t resource, uint32_t frames_back) const {
    return resource < plan.resources.size() && frames_back <= deepest[resource];
  }

  // Returns whether the resource has all of the range. Resources in host memory are never divided.
  bool has(uint32_t number, const SubresourceRange& range) const {
    const PlanResource& resource = plan.resources[number];
    if (resource.first_instance == no_instance) return range == resource.whole();
    return range.mips >= 1 && uint32_t{range.first_mip} + range.mips <= resource.mips &&
           range.layers >= 1 && uint32_t{range.first_layer} + range.layers <= resource.layers;
  }

  void check_resources() {
    for (size_t i = 0; i < plan.resources.size(); ++i) {
      const PlanResource& resource = plan.resources[i];
      const bool buffer = resource.type != ResourceType::image;
      expect(resource.mips >= 1 && resource.mips <= (buffer ? 1 : max_mips) &&
                 resource.layers >= 1 && resource.layers <= (buffer ? 1 : limits::image_layers),
             "a resource has no mips or layers, or too many", i);
      expect(resource.instance_count >= 1, "a resource has no instance", i);
      const bool host = resource.origin == Origin::imported || resource.exported;
      expect(host == (resource.first_instance == no_instance),
             "memory must belong to the host or to a heap, not to both", i);
      expect(host || resource.type != ResourceType::acceleration_structure,
             "an acceleration structure is not owned by the host", i);
      expect(!host || resource.instance_count == 1,
             "a resource of the host must have exactly one instance", i);
      if (host) continue;
      const bool inside =
          range_in(resource.first_instance, resource.instance_count, plan.placements.size());
      expect(inside, "a resource refers to placements that do not exist", i);
      for (uint32_t k = 0; inside && k < resource.instance_count; ++k) {
        const Placement& placement = plan.placements[resource.first_instance + k];
        expect(placement.resource == i, "a placement belongs to another resource", i);
        expect(placement.persistent == (deepest[i] > 0), "only a history may be kept across frames",
               i);
      }
    }
  }

  void check_placements() {
    for (size_t i = 0; i < plan.placements.size(); ++i) {
      const Placement& placement = plan.placements[i];
      expect(placement.resource < plan.resources.size(), "a placement belongs to no resource", i);
      expect(placement.heap < plan.heaps.size(), "a placement is not in a heap", i);
      expect(placement.alignment > 0 && placement.offset % placement.alignment == 0,
             "a placement is misaligned", i);
      if (placement.heap < plan.heaps.size()) {
        const Heap& heap = plan.heaps[placement.heap];
        expect(placement.size <= heap.size && placement.offset <= heap.size - placement.size,
               "a placement exceeds its heap", i);
        expect(placement.alignment > 0 && heap.alignment % placement.alignment == 0,
               "a heap is less aligned than a placement in it", i);
        expect(heap.persistent || !placement.persistent,
               "a history is in a heap whose contents do not last", i);
      }
      expect(placement.size > 0, "a placement has no bytes", i);
      expect(placement.first_use <= placement.last_use &&
                 placement.last_use < std::max<size_t>(plan.passes.size(), 1),
             "a placement is alive outside of the frame", i);
    }
    for (size_t h = 0; h < plan.heaps.size(); ++h)
      expect(plan.heaps[h].memory_type_bits != 0, "no memory type suits a heap", h);
    check_shared_memory();
  }

  static std::pair<uint32_t, uint32_t> lifetime(const Placement& placement) {
    return placement.persistent ? std::pair(0u, UINT32_MAX)
                                : std::pair(placement.first_use, placement.last_use);
  }

  // Checks histories against histories and transients against transients. Memory that a history
  // shares with transients can only be judged by a run over several frames.
  void check_shared_memory() {
    std::vector<size_t> sorted(plan.placements.size());
    for (size_t i = 0; i < sorted.size(); ++i)
      sorted[i] = i;
    const auto key = [&](size_t i) {
      const Placement& placement = plan.placements[i];
      return std::tuple(placement.persistent, placement.heap, lifetime(placement).first, i);
    };
    std::sort(sorted.begin(), sorted.end(), [&](size_t a, size_t b) { return key(a) < key(b); });
    for (size_t i = 0; i < sorted.size();) {
      const Placement& first = plan.placements[sorted[i]];
      size_t end = i;
      while (end < sorted.size() && plan.placements[sorted[end]].persistent == first.persistent &&
             plan.placements[sorted[end]].heap == first.heap)
        ++end;
      check_shared_memory({sorted.data() + i, end - i});
      i = end;
    }
  }

  // Checks placements of one heap, sorted by first use. Live placements share no byte, so a new
  // placement is compared with its two neighbours only.
  void check_shared_memory(std::span<const size_t> sorted) {
    std::map<uint64_t, size_t> alive; // by offset
    // last use and offset of each live placement
    std::set<std::pair<uint32_t, uint64_t>> by_last_use;
    for (const size_t i : sorted) {
      const Placement& own = plan.placements[i];
      while (!by_last_use.empty() && by_last_use.begin()->first < lifetime(own).first) {
        alive.erase(by_last_use.begin()->second);
        by_last_use.erase(by_last_use.begin());
      }
      const auto next = alive.lower_bound(own.offset);
      const auto conflicts = [&](size_t other) {
        const bool overlap = share_memory(own, plan.placements[other]);
        expect(!overlap, "placements that are alive at the same time overlap", std::max(i, other));
        return overlap;
      };
      if ((next != alive.end() && conflicts(next->second)) ||
          (next != alive.begin() && conflicts(std::prev(next)->second)))
        continue;
      alive.emplace(own.offset, i);
      by_last_use.emplace(lifetime(own).second, own.offset);
    }
  }

  // Returns whether the access may be conditional: only reads are, and the fallback of a history
  // read follows that read.
  bool condition_fits(const PlanPass& pass, uint32_t number) const {
    const PlanAccess& access = plan.accesses[pass.first_access + number];
    if (access.when == ReadWhen::always) return true;
    if ((access.access & all_write_access) != 0) return false;
    if (access.when == ReadWhen::history_valid) return access.frames_back > 0;
    if (number == 0) return false;
    const PlanAccess& before = plan.accesses[pass.first_access + number - 1];
    return before.when == ReadWhen::history_valid && before.port == access.port;
  }

  void check_lifetimes(const PlanResource& resource, size_t pass) {
    if (!range_in(resource.first_instance, resource.instance_count, plan.placements.size())) return;
    for (uint32_t i = 0; i < resource.instance_count; ++i) {
      const Placement& placement = plan.placements[resource.first_instance + i];
      expect(placement.first_use <= pass && pass <= placement.last_use,
             "a pass accesses memory outside its lifetime", pass);
    }
  }

  void check_passes() {
    for (size_t p = 0; p < plan.passes.size(); ++p) {
      const PlanPass& pass = plan.passes[p];
      const bool accesses = range_in(pass.first_access, pass.access_count, plan.accesses.size());
      expect(accesses, "a pass refers to accesses that do not exist", p);
      expect(range_in(pass.first_barrier, pass.barrier_count, plan.barriers.size()),
             "a pass refers to barriers that do not exist", p);
      expect(range_in(uint64_t{pass.first_barrier} + pass.barrier_count, pass.release_count,
                      plan.barriers.size()),
             "a pass refers to releases that do not exist", p);
      for (uint32_t a = 0; accesses && a < pass.access_count; ++a) {
        const PlanAccess& access = plan.accesses[pass.first_access + a];
        const bool exists = object_exists(access.resource, access.frames_back);
        expect(condition_fits(pass, a),
               "a conditional read does not name the history whose validity it depends on", p);
        expect(!access.internally_ordered || (access.access & all_write_access) != 0,
               "an internally ordered access does not write", p);
        expect(exists, "a pass accesses a resource or an earlier frame that does not exist", p);
        expect(!exists || plan.resources[access.resource].type != ResourceType::image ||
                   access.layout != Layout::undefined,
               "a pass accesses an image in an undefined layout", p);
        expect(!exists || has(access.resource, access.range),
               "a pass accesses mips or layers that do not exist", p);
        expect((access.stages & ~stage::known) == 0 && (access.access & ~all_known_access) == 0 &&
                   access.stages != 0,
               "an access has no stages, or stages or accesses that do not exist", p);
        if (exists) check_lifetimes(plan.resources[access.resource], p);
      }
    }
    expect(range_in(plan.first_final_barrier, plan.final_barrier_count, plan.barriers.size()),
           "the final batch refers to barriers that do not exist", 0);
    for (size_t b = 0; b < plan.barriers.size(); ++b) {
      const PlanBarrier& barrier = plan.barriers[b];
      const bool exists = object_exists(barrier.resource, barrier.frames_back);
      expect(exists, "a barrier names a resource or an earlier frame that does not exist", b);
      expect(((barrier.source_stages | barrier.destination_stages) & ~stage::known) == 0 &&
                 ((barrier.source_access | barrier.destination_access) & ~all_known_access) == 0,
             "a barrier has stages or accesses that do not exist", b);
      expect(!exists || has(barrier.resource, barrier.range),
             "a barrier names mips or layers that do not exist", b);
      const bool own = exists && plan.resources[barrier.resource].first_instance != no_instance &&
                       deepest[barrier.resource] == 0;
      expect(own || barrier.transfer == PlanBarrier::Transfer::none,
             "only a resource of a single frame can change its queue", b);
    }
  }

  void check_orderings() {
    for (size_t o = 0; o < plan.orderings.size(); ++o)
      expect(plan.orderings[o].earlier < plan.passes.size() &&
                 plan.orderings[o].later < plan.passes.size(),
             "an ordering names passes that do not exist", o);
    expect(std::is_sorted(plan.orderings.begin(), plan.orderings.end()),
           "orderings are not sorted by their passes", 0);
  }

  // Checks that the ranges of a history are as large as its resource.
  void check_ranges(const PlanHistory& history, size_t index) {
    const SubresourceRange whole = plan.resources[history.resource].whole();
    uint64_t size = 0; // number of mips of layers
    for (uint32_t r = 0; r < history.range_count; ++r) {
      const SubresourceRange& range = plan.history_ranges[history.first_range + r];
      expect(has(history.resource, range), "a history has mips or layers that do not exist", index);
      size += uint64_t{range.mips} * range.layers;
    }
    expect(size == uint64_t{whole.mips} * whole.layers,
           "the subresource ranges of a history are not its whole resource", index);
  }

  void check_histories() {
    std::vector<uint32_t> described(plan.resources.size(), 0);
    uint64_t next_range = 0, next_layout = 0; // each history's follow those of the history before
    for (size_t h = 0; h < plan.histories.size(); ++h) {
      const PlanHistory& history = plan.histories[h];
      const bool exists = history.resource < plan.resources.size();
      expect(exists, "a history belongs to no resource", h);
      if (!exists) continue;
      ++described[history.resource];
      expect(plan.resources[history.resource].first_instance != no_instance,
             "a history is in memory of the host", h);
      const uint32_t instances = plan.resources[history.resource].instance_count;
      expect(history.frames >= 1 && history.frames <= limits::history_frames &&
                 history.range_count >= 1 && instances <= history.frames + 1 &&
                 instances >= history.frames &&
                 range_in(history.first_range, history.range_count, plan.history_ranges.size()) &&
                 range_in(history.first_layout,
                          (uint64_t{history.frames} + 1) * history.range_count,
                          plan.history_layouts.size()),
             "a history has the wrong number of instances, subresource ranges or layouts", h);
      const bool in_order =
          history.first_range == next_range && history.first_layout == next_layout;
      expect(in_order, "the subresource ranges of histories are not in the order of the histories",
             h);
      next_range += history.range_count;
      next_layout += (uint64_t{history.frames} + 1) * history.range_count;
      if (in_order && next_range <= plan.history_ranges.size()) check_ranges(history, h);
    }
    // An alias in history memory has as many instances as the history.
    uint32_t maximum = 1;
    for (const PlanHistory& history : plan.histories)
      if (history.resource < plan.resources.size())
        maximum = std::max(maximum, plan.resources[history.resource].instance_count);
    for (size_t r = 0; r < plan.resources.size(); ++r)
      expect(plan.resources[r].instance_count <= maximum,
             "a resource has more instances than any history", r);
    for (size_t r = 0; r < plan.resources.size(); ++r) {
      const uint32_t first = plan.resources[r].first_instance;
      const bool kept = first < plan.placements.size() && plan.placements[first].persistent;
      expect(described[r] == (kept || deepest[r] > 0 ? 1u : 0u),
             "a history is not described exactly once", r);
    }
  }
};

} // namespace

bool share_memory(const Placement& a, const Placement& b) {
  return a.heap == b.heap && a.offset < b.offset + b.size && b.offset < a.offset + a.size;
}

std::vector<std::string> verify_structure(const Plan& plan) {
  Checker checker{plan, {}};
  checker.find_histories();
  checker.check_resources();
  checker.check_placements();
  checker.check_passes();
  checker.check_orderings();
  checker.check_histories();
  return std::move(checker.violations);
}

} // namespace dermis
