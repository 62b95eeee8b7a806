#pragma once
// Keeps the events that count for each range of bytes: the events since these bytes were last
// written as a whole. Work ordered after that write is ordered after everything before that write,
// so earlier events are dropped. The number of events therefore depends on the live resources, not
// on how many resources used the memory one after the other.

#include "framegraph/verify/subresources.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <vector>

namespace dermis {

struct SubresourceEvents {
  uint32_t subresource = 0;
  std::vector<Event> events;

  bool operator==(const SubresourceEvents&) const = default;
};

struct InstanceEvents {
  uint32_t instance = 0;
  std::vector<SubresourceEvents> subresources; // sorted by index

  bool operator==(const InstanceEvents&) const = default;
};

// All bytes of the range have equal events.
struct ByteRange {
  uint64_t end = 0;
  std::vector<InstanceEvents> occupants;
};

class Memory {
public:
  // `plan` must pass verify_structure().
  explicit Memory(const Plan& plan);

  // Adds the subresources of one resource instance. `used_subresources` is the number of them that
  // accesses and barriers of the plan name.
  void add_instance(const Subresource& subresource, uint32_t count, uint32_t used_subresources);
  // Marks a subresource as holding an earlier frame, as the executor left it.
  void set_kept(uint32_t subresource, int64_t of_frame, Layout layout);

  // Calls visit(SubresourceEvents&, bool own) for the subresource itself and for each subresource
  // of another instance that has events on some of the instance's bytes. Subresources of one image
  // share no byte.
  template <class Visit> void for_each_overlap(uint32_t subresource, Visit visit) {
    const uint32_t owner = subresources[subresource].owner;
    const InstanceSubresources& place = instances[owner];
    std::map<uint64_t, ByteRange>& space = spaces_[place.space];
    for (auto range = std::prev(space.upper_bound(place.begin));
         range != space.end() && range->first < place.end; ++range)
      for (InstanceEvents& occupant : range->second.occupants) {
        if (occupant.instance != owner) {
          for (SubresourceEvents& other : occupant.subresources)
            visit(other, false);
        } else if (SubresourceEvents* const own = find(occupant, subresource)) {
          visit(*own, true);
        }
      }
  }

  // Splits byte ranges at the borders of the subresource's instance, so that changes to them affect
  // no other instance.
  void isolate(uint32_t subresource);
  // Adds a read. It replaces earlier reads that wait for the same barriers.
  void add_read(uint32_t subresource, const Event& event);
  // Adds a write or a layout transition. Contents of other instances on the same bytes become
  // undefined.
  void add_write(uint32_t subresource, const Event& event);

  std::vector<Subresource> subresources;
  std::vector<InstanceSubresources> instances;

private:
  static SubresourceEvents* find(InstanceEvents& occupant, uint32_t subresource);
  std::vector<Event>& events_of(ByteRange& range, uint32_t subresource) const;
  template <class Visit> void for_each_range(const InstanceSubresources& place, Visit visit);
  void cut(std::map<uint64_t, ByteRange>& space, uint64_t at);
  void acquire(ByteRange& range, uint32_t owner, bool whole, const Event& write);
  void join(const InstanceSubresources& place);

  const Plan& plan_;
  // one for each heap, then one for each instance in host memory
  std::vector<std::map<uint64_t, ByteRange>> spaces_;
};

} // namespace dermis
