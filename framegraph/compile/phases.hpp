#pragma once
// What the phases of compile() share: one context of flat arrays, filled from top to bottom. Internal to
// compile/.

#include "framegraph/compile/compile.hpp"
#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/pack.hpp"

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace dermis {

inline constexpr uint32_t no_value = 0xffffffffu;

// What most phases ask of a declaration, without its names and places in the file.
struct ResourceInfo {
  ResourceType type = ResourceType::image;
  bool image = true, imported = false, exported = false, optional = false;
  bool host_owned = false; // its memory comes from the host in this plan
  bool history = false;
  uint32_t layers = 1;
  uint32_t parts = 1; // that ports tell apart
};

// Size of a resource at the allocated view size.
struct Extent {
  uint32_t width = 1, height = 1, mips = 1;
  uint64_t bytes = 0; // buffers
};

// One version of one resource within a frame. Version 0 of an import is what the host put there.
struct Value {
  ResourceId resource;
  uint32_t version = 0;
  PassId producer;              // invalid: there before the frame
  uint32_t previous = no_value; // the version this one is written over, in place
};

// One bound port of one pass that is on, or one of the parts of an image that it sees.
struct Use {
  // partly_unwritten: of the parts that the port sees, some are written and others are not.
  enum class BindError : uint8_t {
    none,
    unbound,
    unwritten,
    ambiguous,
    replaced,
    history_unwritten,
    partly_unwritten
  };
  PassId pass;
  ResourceId resource;                                    // whose memory is accessed, after `otherwise`
  ResourceId requested;                                   // as bound in the file
  uint32_t part = 0;                                      // of what is asked for: see CompileContext::parts
  uint32_t read_value = no_value, write_value = no_value; // into CompileContext::values
  uint32_t frames_back = 0;
  uint16_t binding = 0; // into the pass's reads followed by its writes
  uint16_t port = 0;
  Usage usage = Usage::sampled_image;
  ReadWhen when = ReadWhen::always;
  bool reads = false, writes = false; // what the usage does
  BindError bind_error = BindError::none;
};

// When the oldest frame of a history is read for the last time, and when this frame's is first touched.
struct Renewal { // positions in the order
  uint32_t last_read = 0, first_touch = no_value;
  bool own_texels = true; // whether the pass that writes reads the oldest frame in no other way
};

// How a resource is used by the passes that run.
struct Lifetime {
  bool used = false;
  uint32_t vk_usage = 0;
  uint32_t deepest_read = 0;        // largest frames_back that a live pass reads
  bool updates_oldest = false;      // the pass that reads the deepest one writes this frame's over it
  Renewal renewal;                  // of a history that is read
  uint32_t first_narrow = no_value; // into CompileContext::narrow: a port that limits the format
};

struct Interval { // of positions in the order
  uint32_t first = no_value, last = 0;
};

struct NarrowUse { // a use whose port works with some formats only
  uint32_t use = 0;
  uint32_t next = no_value; // of the same resource
};

// How a resource's name is understood at one point of the file: see versions.cpp.
struct Binding {
  uint32_t value = no_value;
  ResourceId later; // valid: whatever the only producer of this resource will write
};

struct ResourceDef {
  uint32_t producers = 0; // passes that are on and write it
  uint32_t first_value = no_value;
  bool replaced = false; // by `otherwise` of a pass that is off
  Binding instead;
};

// How one object (a resource, or one of its earlier frames) stands between two accesses: see synchronize.cpp.
struct ObjectState {
  Stage source_stages = 0;  // the last write, or what its layout transition was made visible to
  Access source_access = 0; // 0 once that write is available
  Stage readers = 0;        // stages that read since
  Layout layout = Layout::undefined;
  uint32_t last_pass = no_value; // position; in the frame before while `carried`
  uint16_t visible = 0;          // usages that may read without another barrier
  Queue queue = Queue::main;     // that touched it last
  bool touched = false;
  bool carried = false;       // from the frame before
  bool read_for_sure = false; // in every frame: whoever waits for the readers waits for the last write
};

// What the walk of synchronize.cpp asks of a plan resource, close together.
struct ResourceSyncInfo {
  uint32_t first_object = 0; // objects follow frames_back, those of one frame its parts
  uint32_t roles = 1;        // frames that a frame touches, this one included: each is an object
  uint32_t parts = 1;        // that ports tell apart: each is an object
  uint32_t own_role = 0;     // frames_back whose object is this frame's, too, since it is written over
  uint32_t memory = 0;       // bytes in which it arrives: into CompileContext::memory
  bool host_owned = false, image = true;
  SubresourceRange whole;
  uint64_t begin = 0, end = 0; // in that memory
};

struct PassTouch { // all accesses of one pass to one object
  uint32_t object = 0, resource = 0, frames_back = 0;
  uint16_t usages = 0;
  bool certain = false; // in every frame
  uint32_t part = 0;
  Layout layout = Layout::undefined;
};

struct HistoryAlias {       // memory of a history that a transient uses while it holds nothing: see
                            // packing/lend.cpp
  uint32_t from = no_value; // into Plan::resources: the history
  bool after = false;       // the last read of its oldest frame; false: before it is written
  uint64_t offset = 0;      // in each of its instances
};

struct Segment { // bytes of a heap and who had them last in this frame; they follow each other without gaps
  uint64_t begin = 0, end = 0;
  uint32_t resource = 0;    // into Plan::resources; no_value: nobody
  uint32_t frames_back = 0; // a history's
};

struct Arrival { // a first use whose bytes nothing in this frame had before
  uint64_t begin = 0, end = 0;
  uint32_t memory = 0, barrier = 0, resource = 0; // into CompileContext::memory
};

// By frames back, 0 .. 2: how many positions, from the first one on. Through waits of both queues, whoever
// knows anything of itself knows all that is older.
using FrameCounts = std::array<uint32_t, 3>;

struct Moment { // of an object; `end`: behind the pass's position, 0 if there was none
  uint32_t frames_back = 0, end = 0;
};

struct Moments {
  Moment touch, write;
};

struct DraftWaits { // of a barrier, on its own queue
  FrameCounts behind{};
  bool layout_kept = false; // what it discards is in the layout that it asks for
};

struct PartArrival { // the first use of a part of an image whose memory another part has taken over
  uint32_t barrier = 0, resource = 0, object = 0;
};

struct Answer { // what memory the device wants for one description
  bool given = false;
  PlanResource to;
  MemoryNeeds needs;
};

struct Shape {      // what all resources that are declared alike have in common
  ResourceId first; // of them
  Extent extent;
  bool answered = false; // for one use: the rest is what came of it
  uint32_t vk_usage = 0;
  Format format = Format::undefined;
  MemoryNeeds needs;
};

struct MemoryGroup { // instances that may share a heap
  bool persistent = false;
  uint32_t type_bits = 0;
  uint32_t buffers = 0, images = 0;
};

// Whether a port that names `seen` sees some of the range.
inline bool meets(const ImagePart& seen, const SubresourceRange& range) {
  const auto overlap = [](uint32_t first, uint32_t count, uint32_t other, uint32_t others) { // count 0: all
    return first < other + others && (count == 0 || other < first + count);
  };
  return overlap(seen.first_mip, seen.mips, range.first_mip, range.mips) &&
         overlap(seen.first_layer, seen.layers, range.first_layer, range.layers);
}

struct CompileContext {
  const CompileInput* input = nullptr;
  const Graph* graph = nullptr;
  const PassTypeRegistry* pass_types = nullptr;
  const DeviceProfile* device = nullptr;
  Diagnostics* diagnostics = nullptr;
  CompiledPlan* out = nullptr;

  // resolve
  std::vector<ResourceInfo> info; // by resource
  std::vector<uint8_t> bound;     // by resource: imports and exports the host binds
  std::vector<Extent> extents;
  std::vector<uint8_t> size_marks;
  std::vector<Shape> shapes;
  std::vector<uint32_t> shape_of;              // by resource: into shapes; no_value: by another's size
  std::array<uint32_t, 32> shape_of_remainder; // by remainder of a hash: the shape met last
  std::vector<ResourceId> size_chain;
  // choose
  std::vector<SettingValue> settings;
  std::vector<uint8_t> on;         // by pass: `when` holds
  std::vector<PassTypeId> kind_of; // by pass
  bool ordered = false;            // some pass has an `after`
  // parts: images of which ports name parts fall into the fewest that every port sees whole. The first part
  // of a resource has the number of the resource, the others follow behind all resources.
  std::vector<uint32_t> further_subresources;             // by resource: number of its second part
  std::vector<SubresourceRange> parts;                    // by part, where Graph::parts
  std::vector<std::array<std::vector<uint16_t>, 2>> cuts; // by resource: where parts begin, mips and layers
  // versions
  std::vector<Value> values;
  std::vector<Use> uses;                // sorted by pass, then port
  std::vector<uint32_t> first_use;      // by pass, and one more: into uses
  std::vector<uint32_t> final_value;    // by part: its version when the frame ends, no_value if none
  std::vector<Binding> current;         // by part
  std::vector<uint32_t> last_version;   // by part: latest value in its own memory
  std::vector<ResourceDef> definitions; // by part
  std::vector<std::pair<uint32_t, uint32_t>> forward; // use -> part to look up when the scan is over
  bool overwrites = false;                            // some value is written over another
  // cull
  std::vector<uint8_t> live;
  std::vector<uint64_t> waiting; // bit set of passes that are needed and whose reads were not looked at
  std::vector<uint8_t> reported; // by resource: one root cause, one diagnostic
  std::vector<Queue> queue;      // by pass, where there are two
  // usage
  std::vector<Lifetime> lifetimes; // by resource
  std::vector<NarrowUse> narrow;
  std::vector<uint32_t> plan_resource;   // by resource: into Plan::resources, or no_value
  std::vector<MemoryNeeds> needs;        // by plan resource; size 0: the host's memory
  std::vector<uint64_t> transient_bytes; // by resource: 0 unless the frame's own
  std::array<Answer, 32> answers;        // of the device, at most one for each remainder of a hash
  // order
  std::vector<PassId> order;
  std::vector<uint32_t> first_before, before;         // by pass, and one more: passes that must run before it
  std::vector<std::pair<uint32_t, uint32_t>> readers; // pass that writes over a value, pass that reads it
  std::vector<uint64_t> peak_bytes, output_bytes;     // by pass
  std::vector<uint32_t> candidate, stack, uses_cursor, position;
  std::vector<Interval> intervals, other_intervals; // by resource and one more, in c.order and in the
                                                    // candidate
  std::vector<int64_t> changes;                     // by position: bytes that come alive less those that die
  std::vector<uint8_t> seen;
  std::vector<uint8_t> pass_type_fits; // by kind: 0 not looked at, 1 within the device's limits, 2 not
  // pack
  std::vector<MemoryGroup> groups;
  std::vector<HistoryAlias> history_aliases; // by plan resource
  std::vector<PackItem> items;
  std::vector<uint32_t> item_placement;
  Packer packer;
  Packing packing;
  // synchronize
  std::vector<ResourceSyncInfo> sync_info; // by plan resource
  std::vector<ObjectState> states, ends;
  std::vector<PassTouch> touches;     // of one pass, and what is left of others
  std::vector<uint32_t> touch_number; // by object: of the last one, counted through all passes
  std::vector<uint32_t> touch_of_use;
  std::vector<uint32_t> aliased_memory;     // by plan resource: into `memory`, of what it lends
  std::vector<std::vector<Segment>> memory; // by heap, then two for each history that lends
  std::vector<PlanBarrier> drafts;          // as found, before they are sorted into batches
  std::vector<uint32_t>
      batch_of; // by draft: position of the pass it stands before; then its place in the plan
  std::vector<uint32_t> batch_filled; // by batch: barriers that have their place, those behind the pass apart
  size_t reasons_before = 0;          // of the other phases
  // By position, where there are two queues: position + 2 of the last pass of the other queue that it comes
  // after, in this frame and in the one before; 0: none.
  std::vector<uint32_t> needs_point, needs_frame_before;
  std::vector<DraftWaits> draft_waits;
  std::vector<Moments> moments, moment_ends; // by object: when it was touched last
  // By position: the first ones hold passes of the same queue that are done and seen by then, since the other
  // queue waited for them and this one for that.
  std::vector<FrameCounts> round_trip;
  std::vector<Arrival> arrivals;
  std::vector<PartArrival> part_arrivals;
  std::vector<uint32_t> part_after; // by plan resource: scratch
  std::vector<uint32_t>
      arrived_after; // by plan resource: last pass that had its memory before it, in this frame
  std::vector<uint32_t>
      arrival_of; // by plan resource: barrier of its first use, unless the host's or a history

  const std::string& name(ResourceId id) const { return graph->resources[id.value].name; }
  const std::string& name(PassId id) const { return graph->passes[id.value].name; }
  const PassType& type(PassId id) const { return (*pass_types)[kind_of[id.value]]; }
  const SourceLocation& place_of(const Use& use) const { // in the file
    return graph->binding_places[graph->passes[use.pass.value].first_binding + use.binding];
  }
  bool split(ResourceId id) const { return info[id.value].parts > 1; }
  uint32_t part_number(ResourceId id, uint32_t index) const {
    return index == 0 ? id.value : further_subresources[id.value] + index - 1;
  }
  uint32_t part_index(const Use& use) const {
    return use.part == use.requested.value ? 0 : use.part - further_subresources[use.requested.value] + 1;
  }
  // Whether some pass writes what the use reads.
  bool is_written(const Use& use) const {
    return (use.frames_back > 0 ? final_value[use.part] : use.read_value) != no_value;
  }
  // The use of a history that `use` stands in for, at the same port; nullptr if it does not.
  const Use* history_of(const Use& use) const {
    if (use.when != ReadWhen::history_invalid) return nullptr;
    const Use* at = &use;
    while (at->when == ReadWhen::history_invalid)
      --at;
    return at;
  }
  bool host_owned(ResourceId id) const { return info[id.value].host_owned; }
  void record_reason(Reason::About about, uint32_t index, Reason::ReasonKind why, uint32_t a = 0,
                     uint32_t b = 0, uint32_t c = 0) {
    if (input->reasons) add_reason({about, why, index, a, b, c});
  }
  void add_reason(const Reason& reason); // apart, so that those who ask for none pay little
};

// The phases, in the order they run. Each adds diagnostics; compile() stops behind a phase that found errors.
void resolve_sizes(CompileContext& context);      // bound slots, extents
void choose(CompileContext& context);             // values of settings; which passes are on
void split_subresources(CompileContext& context); // into which parts do ports divide images?
void resolve_versions(
    CompileContext& context);                // which version each port reads and writes, `otherwise` applied
void report_races(CompileContext& context);  // passes that read what they write
void cull(CompileContext& context);          // which passes run: those that something bound needs
void choose_queues(CompileContext& context); // which passes run beside the others
void gather_usage(CompileContext& context);  // union of usages, deepest read
void resolve_formats(CompileContext& context);      // one format each, Plan::resources, memory needs
void order(CompileContext& context);                // in which order; refuses cycles
void lifetimes(CompileContext& context);            // first and last use, Plan::passes
void pack(CompileContext& context);                 // heaps and placements
bool find_history_aliases(CompileContext& context); // of pack: who uses memory of histories; false: nobody
void synchronize(CompileContext& context);          // accesses and barriers

// The passes marked in c.live in the order of the file, dependencies before all. Only for graphs in which
// some pass needs one that stands behind it. Refuses cycles, also among the passes that are on but not
// needed.
void sort_backward_graph(CompileContext& context);

} // namespace dermis
