#pragma once
// What will run: ordered passes with resolved accesses, batched barriers, heaps with placements, history
// slots. Flat arrays, no pointers; the same inputs give the same bytes. Reasons are a side table.

#include "framegraph/model/graph.hpp"

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

// A physical image or buffer, or the host's acceleration structure. Transients have one instance, or one in
// each instance of a history whose memory they use while it holds nothing; a history resource of which N
// earlier frames are read has N+1, or N where a frame may be written into the memory of the oldest. In frame
// f (counted per view from 0), `frames_back` b of resource r lives in instance first_instance + (f - b) mod
// instance_count.
struct PlanResource {
  ResourceId declared;
  ResourceType type = ResourceType::image;
  Origin origin = Origin::transient;
  bool exported =
      false; // bound by the host: the host owns the memory; an unbound export is an ordinary transient
  Format format = Format::undefined;
  uint32_t width = 1, height = 1, mips = 1, layers = 1; // images, at the allocated view size
  uint64_t bytes = 0;                                   // buffers: size asked for; the host's: the least
  uint32_t vk_usage = 0;                                // of all its ports; histories: and of a clear
  uint32_t instance_count = 1;
  uint32_t first_instance = no_instance; // into Plan::placements; no_instance: the host's memory
  // Everything that the resource has.
  SubresourceRange whole() const {
    return {0, static_cast<uint16_t>(mips), 0, static_cast<uint16_t>(layers)};
  }
  int32_t slot =
      -1; // imports and exports, bound or not: running number among them in the order of Graph::resources
};

struct Placement {       // one physical instance in memory
  uint32_t resource = 0; // into Plan::resources
  uint32_t heap = 0;     // into Plan::heaps
  uint64_t offset = 0, size = 0, alignment = 1;
  uint32_t first_use = 0, last_use = 0; // positions in Plan::passes; history: 0 .. last pass
  bool persistent = false;              // keeps its contents across frames
};

struct Heap {
  uint32_t memory_type_bits = 0xffffffffu; // allowed memory types, all occupants agreed
  uint64_t size = 0, alignment = 1;
  uint64_t max_live_bytes = 0; // lower bound of any packing
  bool persistent = false;     // holds histories, and transients that use their memory; else transients only
};

// async: a second queue of another family, which runs beside the first.
enum class Queue : uint8_t { main, async };

// Points in time, one sequence for each queue: a pass waits until the other queue has reached one, and
// reaches one of its own when it is done. They count from 1 in each frame; 0 is the last one of the frame
// before. As values of a timeline semaphore: frame * (points of a frame) + point.
inline constexpr uint32_t no_point = 0xffffffffu;

struct PlanAccess { // one bound port of one pass
  uint32_t port = 0;
  uint32_t resource = 0; // into Plan::resources
  uint32_t frames_back = 0;
  SubresourceRange range;
  Stage stages = 0;
  Access access = 0;
  Layout layout = Layout::undefined;
  // A read of a resource that the pass writes, in this frame or over an earlier one: each invocation reads
  // only what it writes itself. See Port::own_texels.
  bool own_texels = false;
  // Reads only: in frames in which the earlier frame that this access names is valid, or, behind such an
  // access of the same port, in those in which that one's is not. Barriers are the same in every frame.
  ReadWhen when = ReadWhen::always;
};

// One memory dependency on one resource: an image barrier over a range of mips and layers, or a buffer
// barrier over all bytes (layouts undefined). Source masks name accesses of this frame and of the frames
// before it on the same queue. Every slot the host binds has one barrier with to_host in the final batch; one
// that no pass touches has from_host and to_host in it.
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
  // Between queues, in two halves with the same layouts: released behind a pass of one queue (no
  // destination), acquired before a pass of the other (no source), which waits for a point behind the
  // release.
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
  uint32_t wait = no_point;   // of the other queue, before the barriers
  uint32_t release_count = 0; // barriers behind the pass, which follow those before it in Plan::barriers
  uint32_t signal = 0;        // the point that this queue has reached behind the releases; 0: none
};

// An `after` of the graph whose two passes run: the later one is recorded behind the earlier one, and, where
// they are on different queues, waits for a point behind it.
struct PlanOrdering { // positions in Plan::passes
  uint32_t earlier = 0, later = 0;

  // By which they are sorted.
  friend bool operator<(const PlanOrdering& a, const PlanOrdering& b) { return a.later < b.later; }
};

// History as the executor keeps it. New or invalidated instances must be brought (cleared, or transitioned
// with their contents discarded) into their layout at the start before the first frame that reads them.
struct PlanHistory {
  uint32_t resource = 0;              // into Plan::resources
  uint32_t frames = 1;                // deepest `@-N` this plan reads
  uint32_t first_part = 0, parts = 1; // into Plan::history_parts: those that ports tell apart, or the whole
  uint32_t first_layout = 0;          // into Plan::history_layouts, `parts` for each frames_back 0 .. frames
  HistoryDeclaration declaration;
};

struct Plan {
  std::string graph;                        // name
  uint32_t view_width = 0, view_height = 0; // allocated size
  std::string device_profile;               // name
  std::vector<SettingValue> setting_values; // one per Graph::settings: what `when` was folded with
  std::vector<PlanResource> resources;
  std::vector<Heap> heaps;
  std::vector<Placement> placements;
  std::vector<PlanPass> passes;
  std::vector<PlanAccess> accesses;
  std::vector<PlanBarrier> barriers;
  std::vector<PlanSetting> settings;
  std::vector<PlanOrdering> orderings; // by the later one
  std::vector<PlanHistory> histories;
  std::vector<SubresourceRange> history_parts;
  std::vector<Layout> history_layouts; // of an instance's parts when a frame starts; the newest's is
                                       // undefined: its old contents are discarded
  uint32_t first_final_barrier = 0,
           final_barrier_count = 0; // batch after the last pass: to the host's `after`
  uint32_t final_wait =
      no_point; // point of the async queue that the main one waits for before the final batch
  uint64_t transient_bytes = 0, history_bytes = 0; // heap bytes by kind
};

// Why something was decided, outside the canonical bytes: what the compiler knew, as indices. explain/ makes
// sentences of it. Placements need none: the plan itself tells what lives beside them.
struct Reason {
  enum class About : uint8_t { pass, resource, barrier, choice, order };
  enum class ReasonKind : uint8_t {
    // of a pass; a, b: what needs it, as named here
    off,              // its `when` is false
    read_by,          // pass a reads its resource b
    read_later_by,    // pass a reads its resource b in later frames
    written_over_by,  // pass a writes over its resource b
    writes_export,    // resource a
    side_effects,     // of its pass type
    culling_off,      // asked for by the caller
    beside,           // declared async, and on the async queue
    behind,           // pass a, which its `after` number b names
    not_beside,       // declared async, but resource a is the host's, a history, or bound in parts
    port_unbound,     // optional port a; nothing provides resource b
    always_otherwise, // port a has no history b to read: its `otherwise` stands in for it in every frame
    not_needed,       // culled
    lacks_input_without_bounds, // in frames with empty bounds nobody writes its resource a
    // of a resource
    unbound,            // the host leaves this optional slot alone
    stands_for,         // a by another name, behind pass b, which is off
    unwritten_export,   // optional, and no pass that is on writes it
    format,             // Format a; b: 0 first of the list, 1 first usable one, 2 bound by the host
    format_not_ported,  // not Format a: port c of pass b cannot work with it
    format_unsupported, // not Format a: the device does not support image usage b
    history_unused,     // no pass that runs uses it
    history_unread,     // no pass that runs reads its earlier frames
    history_read,       // earlier frames are read, down to a
    renewed_in_place,   // the oldest frame a has been read when this one is written; b: 1 by the same pass
    aliases_history,    // of history a; b: 0 before that is written, 1 after its oldest frame was read
    // of a barrier; b: 1 if that was in the frame before
    from_host,       // the first access to resource a takes it over
    oldest_instance, // of resource a becomes that of this frame
    first_use,       // of resource a
    behind_last_use, // its own
    takes_memory,    // of resource a
    dependency,      // pass at position c behind that at position a: see PlanBarrier::why
    to_host,         // resource a is handed back; b: 1 if no pass touched it
    // of a setting
    requested, // by the caller
    by_default,
    not_available, // option a: the device lacks features b, or the host leaves import c unbound (0: features)
    // of the order; a, b: KiB of transients alive at once in it, and in the other one that was tried
    order_of_file,
    depth_first,
    program_order, // asked for by the caller
    random_order   // likewise
  };
  About about = About::pass;
  ReasonKind why = ReasonKind::off;
  uint32_t index = 0; // pass: PassId in the graph; resource: ResourceId; choice: SettingId; barrier: index in
                      // the plan; order: 0
  uint32_t a = 0, b = 0, c = 0; // as said at each Why; resources and passes are ids in the graph
};

struct CompiledPlan {
  Plan plan;
  std::vector<Reason> reasons;
};

} // namespace dermis
