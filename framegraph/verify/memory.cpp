#include "framegraph/verify/memory.hpp"

namespace dermis {
namespace {

// Whether the write was checked to come after `event`. Accesses of one pass are not ordered by each other.
bool is_before(const Event& event, const Event& write) {
  return write.access == nullptr || event.access == nullptr || event.at != write.at;
}

} // namespace

Memory::Memory(const Plan& plan) : plan_(plan), spaces_(plan.heaps.size()) {
  for (std::map<uint64_t, ByteRange>& space : spaces_)
    space[0].end = UINT64_MAX;
}

void Memory::add_instance(const Thing& thing, uint32_t count, uint32_t used_things) {
  InstanceThings place{static_cast<uint32_t>(things.size()), count, used_things, 0};
  if (thing.placement != no_instance) {
    const Placement& memory = plan_.placements[thing.placement];
    place.space = memory.heap;
    place.begin = memory.offset;
    place.end = memory.offset + memory.size;
  } else { // the host's: nothing else is located there
    place.space = static_cast<uint32_t>(spaces_.size());
    spaces_.emplace_back()[0].end = UINT64_MAX;
  }
  things.insert(things.end(), count, thing);
  for (uint32_t t = place.first; t < things.size(); ++t)
    things[t].owner = static_cast<uint32_t>(instances.size());
  instances.push_back(place);
}

void Memory::set_kept(uint32_t thing, int64_t of_frame, Layout layout) {
  things[thing].defined = true;
  things[thing].of_frame = of_frame;
  things[thing].layout = layout;
  isolate(thing);
  for_each_range(instances[things[thing].owner], [&](ByteRange& range) { events_of(range, thing); });
}

ThingEvents* Memory::find(InstanceEvents& occupant, uint32_t thing) {
  const auto found = std::lower_bound(occupant.things.begin(), occupant.things.end(), thing,
                                      [](const ThingEvents& a, uint32_t b) { return a.thing < b; });
  return found != occupant.things.end() && found->thing == thing ? &*found : nullptr;
}

std::vector<Event>& Memory::events_of(ByteRange& range, uint32_t thing) const {
  const uint32_t owner = things[thing].owner;
  auto occupant = std::find_if(range.occupants.begin(), range.occupants.end(),
                               [&](const InstanceEvents& one) { return one.instance == owner; });
  if (occupant == range.occupants.end())
    occupant = range.occupants.insert(range.occupants.end(), InstanceEvents{owner, {}});
  const auto at = std::lower_bound(occupant->things.begin(), occupant->things.end(), thing,
                                   [](const ThingEvents& a, uint32_t b) { return a.thing < b; });
  if (at != occupant->things.end() && at->thing == thing) return at->events;
  return occupant->things.insert(at, ThingEvents{thing, {}})->events;
}

// The place must be isolated.
template <class Visit> void Memory::for_each_range(const InstanceThings& place, Visit visit) {
  std::map<uint64_t, ByteRange>& space = spaces_[place.space];
  for (auto range = space.lower_bound(place.begin); range != space.end() && range->first < place.end; ++range)
    visit(range->second);
}

void Memory::cut(std::map<uint64_t, ByteRange>& space, uint64_t at) {
  const auto range = std::prev(space.upper_bound(at));
  if (range->first == at || at >= range->second.end) return;
  space.emplace_hint(std::next(range), at, range->second);
  range->second.end = at;
}

void Memory::isolate(uint32_t thing) {
  const InstanceThings& place = instances[things[thing].owner];
  cut(spaces_[place.space], place.begin);
  cut(spaces_[place.space], place.end);
}

void Memory::add_read(uint32_t thing, const Event& event) {
  isolate(thing);
  for_each_range(instances[things[thing].owner], [&](ByteRange& range) {
    std::vector<Event>& events = events_of(range, thing);
    const auto same = std::find_if(events.rbegin(), events.rend(), [&](const Event& one) {
      return one.is_write ||
             (one.stages == event.stages && one.queue == event.queue && one.ordered == event.ordered);
    });
    if (same == events.rend() || same->is_write) {
      events.push_back(event);
      return;
    }
    same->at = event.at; // whatever waits for the later read waits for the earlier one
    same->access = event.access;
    same->certain |= event.certain;
  });
}

// Holds events that other instances left on these bytes. They count until each used part of the new owner was written.
void Memory::take_over(ByteRange& range, uint32_t owner, bool whole, const Event& write) {
  for (InstanceEvents& other : range.occupants) {
    if (other.instance == owner) continue;
    for (ThingEvents& left : other.things) {
      Thing& thing = things[left.thing];
      thing.defined = false;
      if (thing.written) --instances[other.instance].written_things;
      thing.written = false;
      if (whole) std::erase_if(left.events, [&](const Event& event) { return is_before(event, write); });
    }
    std::erase_if(other.things, [](const ThingEvents& left) { return left.events.empty(); });
  }
  std::erase_if(range.occupants, [](const InstanceEvents& one) { return one.things.empty(); });
}

void Memory::add_write(uint32_t thing, const Event& event) {
  const uint32_t owner = things[thing].owner;
  InstanceThings& place = instances[owner];
  if (!things[thing].written) ++place.written_things;
  things[thing].written = true;
  isolate(thing);
  for_each_range(place, [&](ByteRange& range) {
    take_over(range, owner, place.written_things >= place.used_things, event);
    std::vector<Event>& events = events_of(range, thing);
    std::erase_if(events, [&](const Event& one) { return is_before(one, event); });
    events.push_back(event);
  });
  join(place);
}

// Neighbours of which the same is known become one range.
void Memory::join(const InstanceThings& place) {
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
