#pragma once
// The objects of the barrier phase. An object is one subresource range of one frame of a plan
// resource. Internal to compile/.

#include "framegraph/compile/values.hpp"

#include <vector>

namespace dermis {

// The properties of a plan resource that the walk reads, packed closely.
struct ResourceSyncInfo {
  uint32_t first_object = 0; // objects are sorted by frames_back, then by range
  uint32_t frames = 1;       // frames that passes access, this one included
  uint32_t ranges = 1;       // subresource ranges
  uint32_t own_frame = 0; // frames_back of the objects that this frame overwrites in place; 0: none
  bool host_owned = false, image = true;
  SubresourceRange whole;

  uint32_t objects() const { return frames * ranges; }
  uint32_t object(uint32_t frames_back, uint32_t range = 0) const {
    return first_object + (frames_back == 0 ? own_frame : frames_back) * ranges + range;
  }
  // The object of the oldest frame.
  uint32_t oldest_object(uint32_t range) const {
    return first_object + (frames - 1) * ranges + range;
  }
};

// How an object was accessed so far.
struct ObjectState {
  Stage source_stages =
      0; // of the last write, or that the last layout transition was made visible to
  Access source_access = 0; // 0 after that write was made available
  Access written = 0;       // accesses of the last write, also after that
  Stage readers = 0;        // stages that read since then
  Layout layout = Layout::undefined;
  uint32_t last_pass = invalid_index; // position; in the previous frame if `carried`
  uint16_t visible = 0;               // usages that may read without another barrier
  Queue queue = Queue::main;          // of the last access
  bool accessed = false;
  bool carried = false; // the last access was in the previous frame
  bool always_read =
      false; // a reader runs in every frame: waiting for the readers includes the last write
};

struct SyncScope { // first half of a memory dependency
  Stage stages = 0;
  Access access = 0;
};

// Returns the scope that covers all accesses so far; empty if there was none.
inline SyncScope scope_of(const ObjectState& state) {
  const bool only_readers = (int{state.readers != 0} & int{state.source_access == 0}) != 0;
  return {state.readers | (only_readers ? 0 : state.source_stages), state.source_access};
}

struct SyncObjects {
  std::vector<ResourceSyncInfo> resources;      // by plan resource
  std::vector<ObjectState> states;              // by object
  std::vector<ObjectState> states_at_frame_end; // by object
  bool any_history = false;

  void number(const Subresources& subresources, const Histories& histories, const Plan& plan);
};

} // namespace dermis
