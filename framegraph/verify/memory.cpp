#include "framegraph/verify/memory.hpp"

namespace dermis {
namespace {

// Returns whether `event` was checked to come before `write`. Accesses of one pass are not ordered
// by each other.
bool is_before(const Event& event, const Event& write) {
  return write.access == nullptr || event.access == nullptr || event.at != write.at;
}

} // namespace

Memory::Memory(const Plan& plan) : plan_(plan), spaces_(plan.heaps.size()) {
  for (std::map<uint64_t, ByteRange>& space : spaces_)
    space[0].end = UINT64_MAX;
}

void Memory::add_instance(const Subresource& subresource, uint32_t count,
                          uint32_t used_subresources) {
  InstanceSubresources place{static_cast<uint32_t>(subresources.size()), count, used_subresources,
                             0};
  if (subresource.placement != no_instance) {
    const Placement& memory = plan_.placements[subresource.placement];
    place.space = memory.heap;
    place.begin = memory.offset;
    place.end = memory.offset + memory.size;
  } else { // host memory: nothing else is located there
    place.space = static_cast<uint32_t>(spaces_.size());
    spaces_.emplace_back()[0].end = UINT64_MAX;
  }
  subresources.insert(subresources.end(), count, subresource);
  for (uint32_t t = place.first; t < subresources.size(); ++t)
    subresources[t].owner = static_cast<uint32_t>(instances.size());
  instances.push_back(place);
}

void Memory::set_kept(uint32_t subresource, int64_t of_frame, Layout layout) {
  subresources[subresource].defined = true;
  subresources[subresource].of_frame = of_frame;
  subresources[subresource].layout = layout;
  isolate(subresource);
  for_each_range(instances[subresources[subresource].owner],
                 [&](ByteRange& range) { events_of(range, subresource); });
}

SubresourceEvents* Memory::find(InstanceEvents& occupant, uint32_t subresource) {
  const auto found =
      std::lower_bound(occupant.subresources.begin(), occupant.subresources.end(), subresource,
                       [](const SubresourceEvents& a, uint32_t b) { return a.subresource < b; });
  return found != occupant.subresources.end() && found->subresource == subresource ? &*found
                                                                                   : nullptr;
}

std::vector<Event>& Memory::events_of(ByteRange& range, uint32_t subresource) const {
  const uint32_t owner = subresources[subresource].owner;
  auto occupant = std::find_if(range.occupants.begin(), range.occupants.end(),
                               [&](const InstanceEvents& one) { return one.instance == owner; });
  if (occupant == range.occupants.end())
    occupant = range.occupants.insert(range.occupants.end(), InstanceEvents{owner, {}});
  const auto at =
      std::lower_bound(occupant->subresources.begin(), occupant->subresources.end(), subresource,
                       [](const SubresourceEvents& a, uint32_t b) { return a.subresource < b; });
  if (at != occupant->subresources.end() && at->subresource == subresource) return at->events;
  return occupant->subresources.insert(at, SubresourceEvents{subresource, {}})->events;
}

// The ranges of `place` must be isolated.
template <class Visit> void Memory::for_each_range(const InstanceSubresources& place, Visit visit) {
  std::map<uint64_t, ByteRange>& space = spaces_[place.space];
  for (auto range = space.lower_bound(place.begin);
       range != space.end() && range->first < place.end; ++range)
    visit(range->second);
}

void Memory::cut(std::map<uint64_t, ByteRange>& space, uint64_t at) {
  const auto range = std::prev(space.upper_bound(at));
  if (range->first == at || at >= range->second.end) return;
  space.emplace_hint(std::next(range), at, range->second);
  range->second.end = at;
}

void Memory::isolate(uint32_t subresource) {
  const InstanceSubresources& place = instances[subresources[subresource].owner];
  cut(spaces_[place.space], place.begin);
  cut(spaces_[place.space], place.end);
}

void Memory::add_read(uint32_t subresource, const Event& event) {
  isolate(subresource);
  for_each_range(instances[subresources[subresource].owner], [&](ByteRange& range) {
    std::vector<Event>& events = events_of(range, subresource);
    const auto same = std::find_if(events.rbegin(), events.rend(), [&](const Event& one) {
      return one.is_write || (one.stages == event.stages && one.queue == event.queue &&
                              one.ordered == event.ordered);
    });
    if (same == events.rend() || same->is_write) {
      events.push_back(event);
      return;
    }
    same->at = event.at; // a barrier that waits for the later read waits for the earlier read
    same->access = event.access;
    same->certain |= event.certain;
  });
}

// Drops the events that other instances left on these bytes. They count until each used subresource
// of the new owner has been written.
void Memory::acquire(ByteRange& range, uint32_t owner, bool whole, const Event& write) {
  for (InstanceEvents& other : range.occupants) {
    if (other.instance == owner) continue;
    for (SubresourceEvents& left : other.subresources) {
      Subresource& subresource = subresources[left.subresource];
      subresource.defined = false;
      if (subresource.written) --instances[other.instance].written_subresources;
      subresource.written = false;
      if (whole)
        std::erase_if(left.events, [&](const Event& event) { return is_before(event, write); });
    }
    std::erase_if(other.subresources,
                  [](const SubresourceEvents& left) { return left.events.empty(); });
  }
  std::erase_if(range.occupants,
                [](const InstanceEvents& one) { return one.subresources.empty(); });
}

void Memory::add_write(uint32_t subresource, const Event& event) {
  const uint32_t owner = subresources[subresource].owner;
  InstanceSubresources& place = instances[owner];
  if (!subresources[subresource].written) ++place.written_subresources;
  subresources[subresource].written = true;
  isolate(subresource);
  for_each_range(place, [&](ByteRange& range) {
    acquire(range, owner, place.written_subresources >= place.used_subresources, event);
    std::vector<Event>& events = events_of(range, subresource);
    std::erase_if(events, [&](const Event& one) { return is_before(one, event); });
    events.push_back(event);
  });
  join(place);
}

// Merges adjacent ranges that have equal occupants.
void Memory::join(const InstanceSubresources& place) {
  std::map<uint64_t, ByteRange>& space = spaces_[place.space];
  auto range = space.lower_bound(place.begin);
  for (auto next = std::next(range); next != space.end() && next->first < place.end;) {
    if (range->second.occupants == next->second.occupants) {
      range->second.end = next->second.end;
      next = space.erase(next);
    } else {
      range = next++;
    }
  }
}

} // namespace dermis
