#pragma once
// Declares the parts of an Executor's state and the functions that create and use them. Internal to
// vulkan/executor/. The destroy function of each part also handles partly created state.

#include "framegraph/vulkan/device_memory.hpp"
#include "framegraph/vulkan/executor/kernels.hpp"
#include "framegraph/vulkan/heap_pool.hpp"

#include <array>
#include <optional>

namespace dermis::vulkan {

inline constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
inline constexpr VkAccessFlags2 all_memory =
    VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
inline constexpr uint64_t indirect_entry_bytes = 16; // group counts x, y, z and one unused word

// Memory of one plan heap.
struct HeapMemory {
  MemoryRequest request;
  MemoryBlock block;
  bool owned = false; // false: belongs to the pool
};

// Vulkan objects of one entry of Plan::placements.
struct Instance {
  VkImage image = VK_NULL_HANDLE;
  VkImageView all_mips = VK_NULL_HANDLE, first_mip = VK_NULL_HANDLE;
  VkBuffer buffer = VK_NULL_HANDLE;
  bool aliased = false; // shares bytes with another instance
  bool ready = false;   // histories: holds defined contents in the expected layout
};

// View of a range of mips and layers of one instance.
struct SubresourceView {
  uint32_t instance = 0;
  SubresourceRange range;
  VkImageView view = VK_NULL_HANDLE;
};

// Zeroed resource bound to unbound optional ports.
struct Placeholder {
  VkFormat format = VK_FORMAT_UNDEFINED; // undefined: a buffer
  bool storage = false;                  // image: storage usage; buffer: shaders may write it
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  VkBuffer buffer = VK_NULL_HANDLE;
  MemoryBlock memory;
};

// Binding of descriptor set 1, in the buffer of the tables.
struct TableBinding {
  uint32_t binding = 0;
  VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  uint64_t offset = 0, bytes = 0;
};

struct EnvironmentTables::State {
  const Device& device;
  std::vector<TableBinding> bindings;
  uint64_t bytes = 0;
  bool device_local = false;
  VkBuffer buffer = VK_NULL_HANDLE;
  MemoryBlock memory;

  explicit State(const Device& owner) : device(owner) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
};

struct ViewTables::State {
  std::shared_ptr<const EnvironmentTables> source;
  VkBuffer copy = VK_NULL_HANDLE; // null: kernels read `source`
  MemoryBlock memory;
  bool is_copied = false; // a recorded frame fills `copy`

  explicit State(std::shared_ptr<const EnvironmentTables> from) : source(std::move(from)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
};

// Descriptor set 1.
struct Environment {
  uint64_t constants_bytes = 0;  // 0: binding 0 is not a uniform buffer
  uint64_t constants_stride = 0; // from one frame in flight to the next
  uint64_t counters_bytes = 0;   // 0: no binding has counters
  uint64_t counters_offset = 0, counters_stride = 0;
  uint64_t total_bytes = 0;
  VkBuffer buffer = VK_NULL_HANDLE;
  MemoryBlock memory;
  std::byte* mapped = nullptr; // starts with the constants of frame slot 0
  VkSampler sampler = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE; // null: no environment
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets;  // by frame slot
  std::shared_ptr<ViewTables> tables; // tables of the next frame
  // tables that `sets` refer to
  std::vector<std::shared_ptr<ViewTables>> tables_of_slot;
};

// One descriptor of a pass.
struct PortWrite {
  uint32_t port = 0;
  VkDescriptorType type = VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
  // into State::placeholders; used while the port is unbound
  uint32_t placeholder = no_index;
};

// The object that a descriptor refers to.
struct BoundPort {
  VkImageView view = VK_NULL_HANDLE;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0, bytes = VK_WHOLE_SIZE;
  VkAccelerationStructureKHR structure = VK_NULL_HANDLE;
  uint64_t content_id = 0, view_id = 0; // of a HostImage
  // false: another object may have the same handles, so the descriptor is written again
  bool comparable = true;
  bool operator==(const BoundPort&) const = default;
};

// Descriptor sets of one pass, by frame slot and phase. The phase is the frame counter modulo
// `phases`, a multiple of the instances that the pass alternates between.
struct PassSets {
  uint32_t phases = 1;
  uint32_t first_set = 0;                  // into Descriptors::sets
  uint32_t first_port = 0, port_count = 0; // into Descriptors::ports
  uint32_t checked_count = 0;              // the first of the ports: compared in each frame
  uint32_t first_bound = 0;                // into Descriptors::bound
};

// Descriptor sets 0.
struct Descriptors {
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<PassSets> passes; // by pass; passes without a kernel have no sets
  std::vector<VkDescriptorSet> sets;
  std::vector<uint8_t> is_written; // by set
  std::vector<PortWrite> ports;
  std::vector<BoundPort> bound; // by set: what its checked ports refer to
  // Memory for the writes of one frame. Entry i of `writes` refers to entry i of the others.
  std::vector<VkWriteDescriptorSet> writes;
  std::vector<VkDescriptorImageInfo> images;
  std::vector<VkDescriptorBufferInfo> buffers;
  std::vector<VkWriteDescriptorSetAccelerationStructureKHR> structures; // refer to `handles`
  std::vector<VkAccelerationStructureKHR> handles;
};

// Accesses that a port can bind, as indices into Plan::accesses.
struct PortAccess {
  uint32_t access = no_index; // no_index: not bound
  // into State::histories: `access` is bound only if this history is valid
  uint32_t history = no_index;
  uint32_t otherwise = no_index; // bound if the history is invalid; no_index: nothing
};

struct Pass {
  std::string name;
  uint32_t kernel = no_index; // into State::kernels; no_index: a clear or a host-recorded pass
  PassTypeId host;            // valid: the host records the pass
  uint32_t host_settings = 0; // number of the pass type's settings
  std::vector<PortAccess> ports;
  uint32_t port_mask = 0;                      // ports that are bound in every frame
  std::vector<uint32_t> conditional_ports;     // ports that are bound in some frames
  GroupCount written_groups;                   // for DispatchRule::Domain::written_image
  uint64_t indirect_entries = 1;               // number of entries in its indirect arguments
  std::vector<uint32_t> writable_placeholders; // into State::placeholders
};

struct HistoryRecord {
  std::string name;
  bool written = false; // the plan writes the current instance
  // the graph requests rescaling, and the device supports it
  bool scales = false;
  uint32_t first_rescale_view = no_index; // into Rescaling::views
  uint32_t first_rescale_set = no_index;  // into Rescaling::sets, within each frame slot
  uint32_t age = 0;
  HistoryReason reason = HistoryReason::first_frame;
  HistoryReason lost = HistoryReason::first_frame; // HistoryState::lost
};

// Copies histories from an executor of another size.
struct Rescaling {
  // float, unsigned; null: no history has the type
  std::array<std::shared_ptr<const Pipeline>, 2> pipelines;
  // By rescaled history and instance: a view of all mips to read, then one per mip to write.
  std::vector<VkImageView> views;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets; // by frame slot, rescaled history, frame and mip
  uint32_t sets_per_slot = 0;
};

struct Timestamps {
  VkQueryPool pool = VK_NULL_HANDLE;
  uint32_t per_frame = 0;              // passes + 1
  std::vector<uint64_t> frame_of_slot; // 0: nothing recorded there
  std::vector<uint64_t> ticks;         // buffer for reading one frame
  std::vector<uint64_t> kept;          // ticks of the newest frame whose queries were reused
  uint64_t kept_frame = 0;             // index of that frame; 0: none
};

// Copy of the state that recording a frame changes, from before that frame.
struct FrameSnapshot {
  struct History {
    uint32_t age = 0;
    HistoryReason reason = HistoryReason::first_frame;
    HistoryReason lost = HistoryReason::first_frame;
  };
  bool is_valid = false;
  bool placeholders_ready = false;
  std::shared_ptr<ViewTables> copied_tables; // that the frame fills; null: none
  std::vector<History> histories;            // by history
  std::vector<uint8_t> ready;                // by instance
  Rectangle previous_rectangle;
  uint64_t last_frame_index = 0;
};

// Subresource that is cleared before it is read.
struct ClearTarget {
  VkImage image = VK_NULL_HANDLE;
  VkBuffer buffer = VK_NULL_HANDLE;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED; // layout after the clear
  VkImageSubresourceRange range{};
  bool clear = true; // false: created without transfer usage, contents stay undefined
};

struct Executor::State {
  const Device* device = nullptr;
  std::shared_ptr<const Plan> shared_plan;
  const Plan& plan;
  uint32_t frames_in_flight = 1;
  const HeapPool* heap_pool = nullptr; // may be null
  std::vector<HeapMemory> heaps;
  std::vector<Instance> instances;
  std::vector<SubresourceView> subresource_views;
  // By plan access: first of its subresource_views, one per instance; no_index: the whole image, or
  // no view.
  std::vector<uint32_t> view_of_access;
  std::vector<Placeholder> placeholders;
  bool placeholders_ready = false;
  bool poison = false; // ExecutorInput::poison
  std::vector<std::shared_ptr<const Kernel>> kernels;
  std::shared_ptr<const PlanPipelines> pipelines; // of the next frame
  // by frame slot: pipelines that its frame was recorded with
  std::vector<std::shared_ptr<const PlanPipelines>> pipelines_of_slot;
  std::vector<VkPipeline> chosen_pipelines;  // of the current frame, by plan pass
  std::vector<SettingValue> chosen_settings; // that `chosen_pipelines` were chosen for
  bool chosen = false;                       // both are up to date with `pipelines`
  Environment environment;
  Descriptors descriptors;
  std::vector<Pass> passes;
  std::vector<HistoryRecord> histories;
  Rescaling rescaling;
  // by slot: index into Plan::resources; no_index: the host does not bind the slot
  std::vector<uint32_t> slot_resource;
  Timestamps timestamps;
  bool saw_lost_device = false;
  std::vector<VkImageMemoryBarrier2> image_barriers; // sized for the largest batch
  std::vector<VkBufferMemoryBarrier2> buffer_barriers;
  std::vector<VkMemoryBarrier2> memory_barriers;
  std::vector<ClearTarget> clear_targets; // of the frame that is recorded
  std::vector<uint32_t> push_constants;
  const FunctionTable* commands = nullptr; // functions that the frame is recorded with
  HostPassFunction host_pass = nullptr;
  void* host_pass_user = nullptr;
  std::vector<HostPort> host_ports; // sized for the largest call
  std::vector<SettingValue> host_settings;
  uint64_t frame_counter = 0; // frames recorded
  uint64_t last_frame_index = 0;
  std::vector<uint64_t> frame_of_slot; // last frame_index recorded there; 0: none
  Rectangle previous_rectangle;
  FrameSnapshot snapshot;         // before the last recorded frame; Executor::discard_frame
  FrameSnapshot earlier_snapshot; // before the second to last frame

  explicit State(std::shared_ptr<const Plan> from)
      : shared_plan(std::move(from)), plan(*shared_plan) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
};

using State = Executor::State;

// ---- memory.cpp
Error create_memory(State& state, const Graph& graph); // heaps, images, buffers, views
void destroy_memory(State& state);

// ---- placeholders.cpp
// Returns the index of the placeholder; declares it if it is new.
uint32_t placeholder_for(State& state, const KernelPort& port, bool writes);
Error create_placeholders(State& state);
void destroy_placeholders(State& state);

// ---- environment.cpp
Error create_environment(State& state, std::span<const EnvironmentBinding> bindings,
                         const std::shared_ptr<ViewTables>& tables);
void destroy_environment(State& state);
// Creates the layout of set 1. `layout` is null after an error.
Error create_environment_layout(const Device& device, std::span<const EnvironmentBinding> bindings,
                                VkDescriptorSetLayout& layout);
uint64_t table_alignment(const Device& device); // of each binding's offset in a buffer
inline constexpr VkMemoryPropertyFlags host_memory_properties =
    VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
// A buffer that set 1 refers to.
struct EnvironmentBuffer {
  const char* name = "";
  uint64_t bytes = 0;
  VkBufferUsageFlags usage =
      VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  VkMemoryPropertyFlags required = host_memory_properties;
};
// Creates the buffer and allocates its memory, which is zeroed if it is host-visible. The caller
// frees `buffer` and `memory`, also on an error.
Error create_environment_buffer(const Device& device, const EnvironmentBuffer& description,
                                VkBuffer& buffer, MemoryBlock& memory);

// ---- environment_tables.cpp
// true: its buffer is the same in every frame
bool is_table(size_t binding, const EnvironmentBinding& given);
// Points set 1 of a frame slot at the newest tables. No frame in flight may use the slot.
void refresh_tables(State& state, uint32_t frame_slot) noexcept;
// Records the copy of the newest tables to device-local memory, unless an earlier frame did.
void record_table_copy(State& state, VkCommandBuffer commands) noexcept;
void clear_counters(State& state, uint32_t frame_slot) noexcept;
void write_frame_constants(State& state, uint32_t frame_slot,
                           std::span<const std::byte> constants) noexcept;

// ---- history.cpp
void save_snapshot(State& state) noexcept;
// Returns the access that the port binds in the current frame: an index into Plan::accesses, or
// no_index.
uint32_t access_now(const State& state, const PortAccess& port) noexcept;

// ---- descriptors.cpp
Error create_descriptors(State& state, const PassTypeRegistry& pass_types);
void destroy_descriptors(State& state);
// Returns the set of the pass in the current frame, as an index into Descriptors::sets.
uint32_t set_index(const State& state, size_t pass, uint32_t frame_slot) noexcept;
void write_descriptors(State& state, uint32_t frame_slot, const FrameInput& frame) noexcept;

// ---- barriers.cpp
// Returns the index of the instance that holds the resource as it was `frames_back` frames before
// the current frame.
uint32_t instance_of(const State& state, const PlanResource& resource,
                     uint32_t frames_back) noexcept;
// The accesses that counters written earlier in the frame are made visible to.
enum class CountersTo : uint8_t { nobody, kernel, host };
// One vkCmdPipelineBarrier2 call.
struct BarrierBatch {
  uint32_t first = 0, count = 0;                        // into Plan::barriers
  std::span<const uint32_t> writable_placeholders = {}; // whose writes are ordered
  CountersTo counters = CountersTo::nobody;
};
// Records nothing if the batch is empty.
void record_barriers(State& state, const FrameInput& frame, const BarrierBatch& of) noexcept;
// Makes all earlier writes visible to all later commands, because other commands used the same
// memory.
void record_memory_acquire(State& state, const FrameInput& frame) noexcept;
// queue family transfers from the host
void record_acquires(State& state, const FrameInput& frame) noexcept;
// queue family transfers to the host
void record_releases(State& state, const FrameInput& frame) noexcept;

// ---- history.cpp
// Invalidates the history.
void invalidate_history(HistoryRecord& history, HistoryReason reason) noexcept;
// Invalidates every history.
void invalidate_histories(State& state, HistoryReason reason) noexcept;

// ---- history_copy.cpp
struct CarriedHistory {
  uint32_t history = no_index; // into State::histories of the other executor
  uint32_t age = 0;            // 0: nothing can be used
};
// Returns which history of `from`, the previous frame's executor, history `index` of `to`
// continues. Name, format and writing pass type must match; the size may differ if the history can
// be rescaled. `reset`: the camera cut.
CarriedHistory carried_history(const State& to, uint32_t index, const State& from,
                               bool reset) noexcept;
// Returns the rectangle of the previous frame in pixels of `to`.
Rectangle carried_rectangle(const State& to, const State& from) noexcept;
// Must be called before anything is written for the frame.
void carry_ages(State& to, const State& from, bool reset) noexcept;
void record_carried(State& to, const State& from, VkCommandBuffer commands, uint32_t frame_slot,
                    bool reset) noexcept;

// ---- history_rescale.cpp
// Returns whether a history with this declaration can be rescaled on the device.
bool can_rescale(const Device& device, const PlanResource& resource,
                 const HistoryDeclaration& declaration) noexcept;
Error create_rescaling(State& state, const ExecutorInput& input); // after create_memory
void destroy_rescaling(State& state);
struct RescaledHistory {
  uint32_t history = 0, source_history = 0; // into State::histories of both executors
  uint32_t frames_back = 1;
  uint32_t frame_slot = 0;
};
// Records the copy of one frame of a history. Both images must be in layout GENERAL.
void record_rescaling(State& to, const State& from, VkCommandBuffer commands,
                      const RescaledHistory& which) noexcept;

// ---- host_pass.cpp
// also allocates memory for their calls
Error check_host_passes(State& state, const ExecutorInput& input);
void run_host_pass(State& state, const FrameInput& frame, size_t p,
                   const Rectangle& rectangle) noexcept;

// ---- clear.cpp
void reserve_clear_targets(State& state); // so that recording does not allocate
// Clears placeholders and new or invalid history instances, and moves them to the layout that the
// plan expects.
void record_initialisation(State& state, VkCommandBuffer commands) noexcept;

// ---- debug_fill.cpp
// Returns whether the barrier discards the earlier contents.
bool discards(const Plan& plan, const PlanBarrier& barrier) noexcept;
// Records the barrier `image` or `buffer` in two halves, with the fill between them.
void record_poison(State& state, VkCommandBuffer commands, const VkImageMemoryBarrier2& image,
                   Format format) noexcept;
void record_poison(State& state, VkCommandBuffer commands,
                   const VkBufferMemoryBarrier2& buffer) noexcept;

// ---- timestamps.cpp
Error create_timestamps(State& state);
void begin_timestamps(State& state, VkCommandBuffer commands, uint32_t frame_slot) noexcept;
void write_timestamp(State& state, VkCommandBuffer commands, uint32_t frame_slot,
                     uint32_t index) noexcept;

} // namespace dermis::vulkan
