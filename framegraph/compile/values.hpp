#pragma once
// Values that the compile phases pass on. Each struct is the result of one phase; later phases only
// read it. Internal to compile/.

#include "framegraph/compile/compile.hpp"

#include <span>
#include <vector>

namespace dermis {

inline constexpr uint32_t invalid_index = 0xffffffffu;

// Receives what phases report: diagnostics for the user, and the reason for each decision.
struct Report {
  Diagnostics& diagnostics;
  std::vector<Reason>& reasons;
  bool reasons_requested = true;
  uint64_t errors_before = 0; // errors in `diagnostics` before compilation

  bool failed() const { return diagnostics.errors() != errors_before; }
  void record_reason(Reason::About about, uint32_t index, Reason::ReasonKind why, uint32_t a = 0,
                     uint32_t b = 0, uint32_t c = 0) {
    if (reasons_requested) add_reason({about, why, index, a, b, c});
  }
  void add_reason(const Reason& reason); // not inline: most compilations request no reasons
};

inline const std::string& name_of(const Graph& graph, ResourceId id) {
  return graph.resources[id.value].name;
}
inline const std::string& name_of(const Graph& graph, PassId id) {
  return graph.passes[id.value].name;
}

// ---- Sizes: see sizes.cpp ----

// The properties of a declaration that most phases read, packed closely.
struct ResourceInfo {
  ResourceType type = ResourceType::image;
  bool image = true, imported = false, exported = false, optional = false;
  bool bound = false;      // an import or export that the host binds
  bool host_owned = false; // the host allocates the memory in this plan
  bool history = false;    // earlier frames are declared
  uint32_t layers = 1;
};

// Size of a resource at the allocated view size.
struct Extent {
  uint32_t width = 1, height = 1, mips = 1; // texels; buffers: elements
  uint64_t bytes = 0;                       // buffers only

  bool known() const { return width != 0; } // false: the size has an error
};

struct SizeError { // reported if the plan needs the resource or a size that follows its size
  ResourceId resource;
  Diagnostic diagnostic;
};

struct Sizes {
  std::vector<ResourceInfo> info; // by resource
  std::vector<Extent> extents;    // by resource
  // By resource: number of its shape. Resources of one shape have equal sizes, mips, layers and
  // formats. invalid_index: the size follows another resource's.
  std::vector<uint32_t> shape_of;
  uint32_t shape_count = 0;
  std::vector<SizeError> errors;
};

// ---- Activation: see activation.cpp ----

struct Activation {
  const PassTypeRegistry* pass_types = nullptr;
  std::vector<SettingValue> settings; // by setting
  std::vector<uint8_t> on;            // by pass: `when` holds
  std::vector<PassTypeId> type_of;    // by pass
  bool ordered = false;               // some pass has an `after`

  const PassType& type(PassId pass) const { return (*pass_types)[type_of[pass.value]]; }
};

// ---- Subresources: see subresources.cpp ----

struct Use;

// Subresource ranges of all images. The first range of a resource has the number of the resource;
// the others are numbered after all resources. Without named ranges in the graph, all vectors are
// empty.
struct Subresources {
  std::vector<uint32_t> counts;         // by resource
  std::vector<uint32_t> second;         // by resource: number of its second range
  std::vector<SubresourceRange> ranges; // by number

  bool any() const { return !counts.empty(); }
  uint32_t count(ResourceId id) const { return any() ? counts[id.value] : 1; }
  bool divided(ResourceId id) const { return count(id) > 1; }
  uint32_t number(ResourceId id, uint32_t index) const {
    return index == 0 ? id.value : second[id.value] + index - 1;
  }
  uint32_t index_of(const Use& use) const; // within the requested resource
};

// Returns whether a port that names `seen` accesses some of the range.
inline bool overlaps(const ImageRange& seen, const SubresourceRange& range) {
  const auto meet = [](uint32_t first, uint32_t count, uint32_t other,
                       uint32_t others) { // count 0: all
    return first < other + others && (count == 0 || other < first + count);
  };
  return meet(seen.first_mip, seen.mips, range.first_mip, range.mips) &&
         meet(seen.first_layer, seen.layers, range.first_layer, range.layers);
}

// ---- Versions: see versions.cpp ----

// One version of one subresource within a frame. Version 0 of an import is written by the host.
struct Version {
  ResourceId resource;
  uint32_t number = 0;
  PassId producer;                   // invalid: the contents exist before the frame
  uint32_t previous = invalid_index; // the version that this one overwrites in place
};

// One bound port of one pass that is on; for a divided image, one subresource range that the port
// accesses.
struct Use {
  enum class BindError : uint8_t {
    none,
    unbound,
    unwritten,
    ambiguous,
    replaced,
    history_unwritten,
    partly_unwritten // some of the port's subresource ranges are written and others are not
  };
  PassId pass;
  ResourceId resource;      // whose memory is accessed, after `otherwise`
  ResourceId requested;     // as bound in the file
  uint32_t subresource = 0; // number in Subresources
  uint32_t read_version = invalid_index, write_version = invalid_index; // into Versions::list
  uint32_t frames_back = 0;
  uint16_t binding = 0; // into the pass's reads followed by its writes
  uint16_t port = 0;
  Usage usage = Usage::sampled_image;
  ReadWhen when = ReadWhen::always;
  bool reads = false, writes = false; // according to the usage
  BindError bind_error = BindError::none;
};

struct Versions {
  std::vector<Version> list;
  std::vector<Use> uses;               // sorted by pass, then port
  std::vector<uint32_t> first_use;     // by pass, and one more: into uses
  std::vector<uint32_t> final_version; // by subresource: at the end of the frame, or invalid_index
  bool overwrites = false;             // some version overwrites another one

  const Version& operator[](uint32_t index) const { return list[index]; }
  std::span<const Use> uses_of(uint32_t pass) const {
    return {uses.data() + first_use[pass], first_use[pass + 1] - first_use[pass]};
  }
  std::span<const Use> uses_of(PassId pass) const { return uses_of(pass.value); }
  // Returns whether some pass writes what the use reads.
  bool is_written(const Use& use) const {
    return (use.frames_back > 0 ? final_version[use.subresource] : use.read_version) !=
           invalid_index;
  }
};

// If `use` is read only while a history is invalid, returns the use of that history at the same
// port; otherwise nullptr.
inline const Use* history_of(const Use& use) {
  if (use.when != ReadWhen::history_invalid) return nullptr;
  const Use* at = &use;
  while (at->when == ReadWhen::history_invalid)
    --at;
  return at;
}

inline const SourceLocation& location_of(const Graph& graph, const Use& use) {
  return graph.binding_places[graph.passes[use.pass.value].first_binding + use.binding];
}

inline uint32_t Subresources::index_of(const Use& use) const {
  return use.subresource == use.requested.value ? 0
                                                : use.subresource - second[use.requested.value] + 1;
}

// ---- LiveSet, QueueAssignment: see cull.cpp, queues.cpp ----

struct LiveSet {
  std::vector<uint8_t> passes;       // by pass: runs in this plan
  std::vector<uint32_t> failed_uses; // into Versions::uses: of live passes, without a version

  bool contains(PassId pass) const { return passes[pass.value] != 0; }
};

struct QueueAssignment {
  std::vector<Queue> by_pass; // empty: all passes run on the main queue

  bool two() const { return !by_pass.empty(); }
};

// ---- Usages, PlanResources: see usages.cpp, formats.cpp ----

// How the passes that run use one resource.
struct ResourceUsage {
  bool used = false;
  uint32_t vk_usage = 0;
  uint32_t deepest_read = 0;                 // largest frames_back that a live pass reads
  uint32_t first_constraint = invalid_index; // into Usages::constraints
};

struct FormatConstraint { // a use whose port works with some formats only
  uint32_t use = 0;
  uint32_t next = invalid_index; // constraint of the same resource
};

struct Usages {
  std::vector<ResourceUsage> resources; // by resource
  std::vector<FormatConstraint> constraints;
};

struct ResourceMemory {
  std::vector<uint32_t> plan_index;      // by resource: into Plan::resources, or invalid_index
  std::vector<MemoryNeeds> needs;        // by plan resource; size 0: the host allocates
  std::vector<uint64_t> transient_bytes; // by resource: 0 unless transient
};

// ---- Schedule, Histories, Placements: see schedule.cpp, histories.cpp, placements.cpp ----

struct Interval { // of positions in the schedule, inclusive
  uint32_t first = invalid_index, last = 0;
};

struct Schedule {
  std::vector<PassId> order;
  std::vector<Interval> lifetimes; // by resource, and one more for uses that do not count
};

// When the oldest frame of a history is read for the last time, and when this frame's is first
// accessed.
struct HistoryLifetime {
  uint32_t frames = 0;                   // earlier frames that live passes read; 0: no history
  uint32_t last_read = 0;                // position
  uint32_t first_access = invalid_index; // position; invalid_index: not known, or never
  bool oldest_updated = false; // the pass that reads the oldest frame overwrites it in place
};

struct Histories {
  std::vector<HistoryLifetime> by_resource; // by plan resource
};

struct HistoryAlias { // idle memory of a history that a transient uses: see history_aliasing.cpp
  uint32_t target = invalid_index; // plan resource of the history
  bool after_last_read = false; // of its oldest frame; false: before this frame's is first accessed
  uint64_t offset = 0;          // bytes, in each of its instances
};

struct Placements {
  std::vector<HistoryAlias> history_aliases; // by plan resource
};

} // namespace dermis
