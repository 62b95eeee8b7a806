#pragma once
// The plan: ordered passes with resolved accesses, batched barriers, heaps with placements,
// histories. Flat arrays without pointers; the same inputs give the same bytes. Reasons are a side
// table.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pixel_grid.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dermis {

inline constexpr uint32_t no_instance = 0xffffffffu;

// As in VkImageSubresourceRange. Buffers have one mip and one layer.
struct SubresourceRange {
  uint16_t first_mip = 0, mips = 1;
  uint16_t first_layer = 0, layers = 1;

  constexpr bool operator==(const SubresourceRange&) const = default;
};

// A physical image or buffer, or the host's acceleration structure. Number of instances:
// - a transient: 1, or that of the history whose idle memory it aliases;
// - a history of which N earlier frames are read: N + 1, or N if a frame is written over the oldest
// one. In frame f (counted per view from 0), `frames_back` b of a resource is located in instance
// first_instance + (f - b) mod instance_count.
struct PlanResource {
  ResourceId declared;
  ResourceType type = ResourceType::image;
  Origin origin = Origin::transient;
  // The host binds the export and owns the memory. An unbound export is an ordinary transient.
  bool exported = false;
  Format format = Format::undefined;
  uint32_t width = 1, height = 1, mips = 1, layers = 1; // images, at the allocated view size
  uint64_t bytes = 0;    // buffers: requested size; of the host's buffers: minimum size
  uint32_t vk_usage = 0; // of all ports; histories: also of a clear
  uint32_t instance_count = 1;
  uint32_t first_instance = no_instance; // into Plan::placements; no_instance: the host's memory
  // Imports and exports, bound or not: running number among them in the order of Graph::resources.
  int32_t slot = -1;

  SubresourceRange whole() const {
    return {0, static_cast<uint16_t>(mips), 0, static_cast<uint16_t>(layers)};
  }
};

struct Placement {       // one physical instance in memory
  uint32_t resource = 0; // into Plan::resources
  uint32_t heap = 0;     // into Plan::heaps
  uint64_t offset = 0, size = 0, alignment = 1;
  uint32_t first_use = 0, last_use = 0; // positions in Plan::passes; history: 0 .. last pass
  bool persistent = false;              // keeps its contents across frames
};

struct Heap {
  uint32_t memory_type_bits = 0xffffffffu; // memory types that all occupants allow
  uint64_t size = 0, alignment = 1;
  uint64_t max_live_bytes = 0; // lower bound of any packing
  bool persistent = false;     // histories and transients that alias them; else only transients
};

// async: a second queue of another family, which runs concurrently with the main queue.
enum class Queue : uint8_t { main, async };

// Timeline points, one sequence for each queue: a pass waits until the other queue has signalled a
// point, and signals a point of its own queue when it is complete. Points count from 1 in each
// frame; 0 is the last point of the previous frame. Value of a timeline semaphore: frame * (points
// of a frame) + point.
inline constexpr uint32_t no_point = 0xffffffffu;

struct PlanAccess { // one bound port of one pass
  uint32_t port = 0;
  uint32_t resource = 0; // into Plan::resources
  uint32_t frames_back = 0;
  SubresourceRange range;
  Stage stages = 0;
  Access access = 0;
  Layout layout = Layout::undefined;
  // A read of a resource that the pass writes, in this frame or over an earlier one, where each
  // invocation reads only texels that it writes itself. See Port::own_texels.
  bool own_texels = false;
  // A write whose kernel also reads what its dispatch wrote, and orders these accesses by itself:
  // `access` contains the read, which needs no earlier contents. See Port::internally_ordered.
  bool internally_ordered = false;
  // Reads only. history_valid: in frames in which the history of this access is valid.
  // history_invalid: in the other frames; the access follows the history's access of the same port.
  // Barriers are the same in every frame.
  ReadWhen when = ReadWhen::always;
};

// One memory dependency on one resource: an image barrier over a range of mips and layers, or a
// buffer barrier over all bytes (layouts undefined). Source masks include accesses of this frame
// and of earlier frames on the same queue. Every slot that the host binds has one barrier with
// to_host in the final batch. If no pass accesses the slot, that barrier has from_host, too.
struct PlanBarrier {
  uint32_t resource = 0;
  uint32_t frames_back = 0;
  SubresourceRange range;
  Stage source_stages = 0, destination_stages = 0;
  Access source_access = 0, destination_access = 0;
  Layout old_layout = Layout::undefined, new_layout = Layout::undefined;
  enum class ReasonKind : uint8_t {
    first_use,
    read_after_write,
    write_after_read,
    write_after_write,
    layout,
    alias,
    history,
    host_before,
    host_after
  } why = ReasonKind::first_use;
  bool from_host = false; // source scope and old layout come from the binding's `before`
  bool to_host = false;   // destination scope and new layout come from the binding's `after`
  // Queue family ownership transfer in two halves with the same layouts: a release after a pass of
  // one queue (no destination), and an acquire before a pass of the other queue (no source), which
  // waits for a point after the release.
  enum class Transfer : uint8_t { none, release, acquire } transfer = Transfer::none;
};

struct PlanSetting { // value of one setting of one pass type, resolved
  SettingId from;    // valid: follows this run-time setting; `value` is its value at compile time
  SettingValue value;
};

struct PlanPass {
  PassId declared;
  PassTypeId type;
  uint32_t first_access = 0, access_count = 0;   // into Plan::accesses
  uint32_t first_barrier = 0, barrier_count = 0; // into Plan::barriers: one batch before the pass
  uint32_t first_setting = 0;                    // into Plan::settings, one per PassTypeSetting
  Queue queue = Queue::main;
  uint32_t wait = no_point; // for a point of the other queue, before the barriers
  uint32_t release_count =
      0;               // barriers after the pass; they follow its first batch in Plan::barriers
  uint32_t signal = 0; // point that this queue signals after the releases; 0: none
};

// An `after` of the graph whose two passes run: the later pass is recorded after the earlier one.
// On different queues, the later pass waits for a point after the earlier one.
struct PlanOrdering { // positions in Plan::passes
  uint32_t earlier = 0, later = 0;

  // Order of Plan::orderings.
  friend bool operator<(const PlanOrdering& a, const PlanOrdering& b) { return a.later < b.later; }
};

// A history as the executor keeps it. Before the first frame that reads a new or invalidated
// instance, the executor clears it, or discards its contents in a transition, so that it has the
// layout that its frame starts with.
struct PlanHistory {
  uint32_t resource = 0;                     // into Plan::resources
  uint32_t frames = 1;                       // deepest `@-N` this plan reads
  uint32_t first_range = 0, range_count = 1; // into Plan::history_ranges: subresource ranges
  uint32_t first_layout =
      0; // into Plan::history_layouts, `range_count` for each frames_back 0 .. frames
  HistoryDeclaration declaration;
};

struct Plan {
  std::string graph;                        // name
  uint32_t view_width = 0, view_height = 0; // allocated size
  PixelGrid pixel_grid = 0;                 // of the pixels of the view
  std::string device_profile;               // name
  std::vector<SettingValue> setting_values; // one per Graph::settings: used to evaluate `when`
  std::vector<PlanResource> resources;
  std::vector<Heap> heaps;
  std::vector<Placement> placements;
  std::vector<PlanPass> passes;
  std::vector<PlanAccess> accesses;
  std::vector<PlanBarrier> barriers;
  std::vector<PlanSetting> settings;
  std::vector<PlanOrdering> orderings; // sorted by the later pass
  std::vector<PlanHistory> histories;
  std::vector<SubresourceRange> history_ranges;
  // Layouts of the ranges of an instance at the start of a frame; undefined for the newest
  // instance, whose old contents are discarded.
  std::vector<Layout> history_layouts;
  // The batch after the last pass: to the host's `after` states.
  uint32_t first_final_barrier = 0, final_barrier_count = 0;
  // Point of the async queue that the main queue waits for before the final batch.
  uint32_t final_wait = no_point;
  uint64_t transient_bytes = 0, history_bytes = 0; // heap bytes by kind
};

// The reason for one decision, outside the canonical bytes. Indices only; explain/ turns them into
// sentences. Placements have no reasons: the plan shows which resources share memory.
struct Reason {
  enum class About : uint8_t { pass, resource, barrier, choice, order };
  enum class ReasonKind : uint8_t {
    // of a pass; a, b: as stated here
    off,              // its `when` is false
    read_by,          // pass a reads its resource b
    read_later_by,    // pass a reads its resource b in later frames
    overwritten_by,   // pass a overwrites its resource b
    writes_export,    // resource a
    side_effects,     // of its pass type
    culling_off,      // requested by the caller
    async_queue,      // declared async, and on the async queue
    after_pass,       // runs after pass a, which its `after` number b names
    not_async,        // declared async, but resource a is the host's, a history, or divided
    port_unbound,     // optional port a; no pass or binding provides resource b
    always_otherwise, // port a has no history b: it reads its `otherwise` in every frame
    not_needed,       // culled
    lacks_input_without_bounds, // in frames with empty bounds no pass writes its resource a
    // of a resource
    unbound,            // the host does not bind this optional slot
    replaced_by,        // readers get resource a, because pass b is off
    unwritten_export,   // optional, and no pass that is on writes it
    format,             // Format a; b: 0 first of the list, 1 first usable one, 2 bound by the host
    format_not_ported,  // not Format a: port c of pass b cannot work with it
    format_unsupported, // not Format a: the device does not support image usage b
    format_unfiltered,  // not Format a: port c of pass b needs a filter that the device lacks
    history_unused,     // no pass that runs uses it
    history_unread,     // no pass that runs reads its earlier frames
    history_read,       // earlier frames are read, down to a
    overwritten_in_place, // this frame overwrites frame a after its last read; b: 1 by the same
                          // pass
    aliases_history, // of resource a; b: 0 before its write, 1 after its oldest frame's last read
    // of a barrier; b: 1 if the earlier access was in the previous frame
    from_host,       // the first access to resource a, which the host passed in
    oldest_instance, // of resource a becomes this frame's
    first_use,       // of resource a
    after_last_use,  // after the last use of the same resource a
    acquires_memory, // acquires memory of resource a
    dependency,      // pass at position c after the pass at position a: see PlanBarrier::why
    to_host,         // resource a is passed back; b: 1 if no pass accessed it
    // of a setting
    requested, // by the caller
    by_default,
    not_available, // option a: the device lacks features b, or (b: 0) import c is unbound
    // of the order; a, b: KiB of transients live at once in this order, and in the other order that
    // was tried
    order_of_file,
    depth_first,
    program_order, // requested by the caller
    random_order   // requested by the caller
  };
  About about = About::pass;
  ReasonKind why = ReasonKind::off;
  // pass: PassId in the graph; resource: ResourceId; choice: SettingId; barrier: index in the plan;
  // order: 0.
  uint32_t index = 0;
  uint32_t a = 0, b = 0,
           c = 0; // as stated at each ReasonKind; resources and passes are ids in the graph
};

struct CompiledPlan {
  Plan plan;
  std::vector<Reason> reasons;
};

} // namespace dermis
