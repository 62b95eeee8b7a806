#pragma once
// Which events count for which bytes: those since the bytes were last written as a whole. Whatever is ordered
// after that write is ordered after everything before it, so earlier events are dropped. The number of events
// therefore follows what is alive, and not how many resources used the same memory one after the other.

#include "framegraph/verify/subresources.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace dermis {

struct ThingEvents {
  uint32_t subresource = 0;
  std::vector<Event> events;

  bool operator==(const ThingEvents&) const = default;
};

struct InstanceEvents {
  uint32_t instance = 0;
  std::vector<ThingEvents> subresources; // sorted by thing

  bool operator==(const InstanceEvents&) const = default;
};

struct ByteRange { // every byte of it has the same events
  uint64_t end = 0;
  std::vector<InstanceEvents> occupants;
};

class Memory {
public:
  // `plan` must pass verify_structure().
  explicit Memory(const Plan& plan);

  // Adds the things of one resource instance. `used_subresources` is how many of them the plan ever touches.
  void add_instance(const Subresource& subresource, uint32_t count, uint32_t used_subresources);
  // The thing holds an earlier frame, as the executor made it.
  void set_kept(uint32_t subresource, int64_t of_frame, Layout layout);

  // Calls visit(ThingEvents&, bool own) for the thing itself and for each thing of another instance that has
  // events on some of its bytes. Parts of one image share no byte.
  template <class Visit> void for_each_meeting(uint32_t subresource, Visit visit) {
    const uint32_t owner = subresources[subresource].owner;
    const InstanceSubresources& place = instances[owner];
    std::map<uint64_t, ByteRange>& space = spaces_[place.space];
    for (auto range = std::prev(space.upper_bound(place.begin));
         range != space.end() && range->first < place.end; ++range)
      for (InstanceEvents& occupant : range->second.occupants) {
        if (occupant.instance != owner) {
          for (ThingEvents& other : occupant.subresources)
            visit(other, false);
        } else if (ThingEvents* const own = find(occupant, subresource)) {
          visit(*own, true);
        }
      }
  }

  // Makes the ranges of bytes end where the thing does, so that what is changed of them concerns no others.
  void isolate(uint32_t subresource);
  // Adds a read. It replaces earlier reads that wait for the same barriers.
  void add_read(uint32_t subresource, const Event& event);
  // Adds a write or a layout transition. Contents of other things on the same bytes become undefined.
  void add_write(uint32_t subresource, const Event& event);

  std::vector<Subresource> subresources;
  std::vector<InstanceSubresources> instances;

private:
  static ThingEvents* find(InstanceEvents& occupant, uint32_t subresource);
  std::vector<Event>& events_of(ByteRange& range, uint32_t subresource) const;
  template <class Visit> void for_each_range(const InstanceSubresources& place, Visit visit);
  void cut(std::map<uint64_t, ByteRange>& space, uint64_t at);
  void take_over(ByteRange& range, uint32_t owner, bool whole, const Event& write);
  void join(const InstanceSubresources& place);

  const Plan& plan_;
  std::vector<std::map<uint64_t, ByteRange>> spaces_; // one for each heap, then one for each host instance
};

} // namespace dermis
