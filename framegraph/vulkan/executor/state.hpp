#pragma once
// What an Executor keeps, part by part, and the functions that make and use the parts. Internal to
// vulkan/executor/. Each part frees itself from its destroy function, whatever of it exists.

#include "framegraph/vulkan/device_memory.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/heap_pool.hpp"

#include <array>
#include <optional>

namespace dermis::vulkan {

inline constexpr uint32_t no_index = 0xffffffffu;
inline constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
inline constexpr VkAccessFlags2 all_memory = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
inline constexpr uint64_t indirect_entry_bytes = 16; // group counts x, y, z and one more word

struct HeapMemory { // of a plan heap
  MemoryRequest request;
  MemoryBlock block;
  bool owned = false; // false: of the pool
};

struct Instance { // of a plan resource, one per Plan::placements
  VkImage image = VK_NULL_HANDLE;
  VkImageView all_mips = VK_NULL_HANDLE, first_mip = VK_NULL_HANDLE;
  VkBuffer buffer = VK_NULL_HANDLE;
  bool shared = false; // has bytes in common with another instance
  bool ready = false;  // histories: holds defined contents in the layout that the plan expects
};

struct PartView { // of a range of mips and layers of one instance
  uint32_t instance = 0;
  SubresourceRange range;
  VkImageView view = VK_NULL_HANDLE;
};

struct StandIn {                         // what an unbound optional port sees: zero
  VkFormat format = VK_FORMAT_UNDEFINED; // undefined: the buffer
  bool storage = false;                  // image: of that use; buffer: a shader may write it
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE;
  VkBuffer buffer = VK_NULL_HANDLE;
  MemoryBlock memory;
};

struct KernelPort {
  std::optional<VkDescriptorType> type;
  VkFormat placeholder = VK_FORMAT_UNDEFINED; // format of the image an unbound port would see
};

struct Kernel { // one per pass type that dispatches; shared by the executors that run it
  const Device* device = nullptr;
  PassTypeId type;
  uint64_t version = 0; // KernelCode::version
  DispatchShape dispatch = DispatchShape::none;
  uint32_t indirect_port = no_index;
  uint32_t entry_setting = no_index; // of the pass type: says which entry of the indirect arguments counts
  std::vector<KernelPort> ports;
  bool counts = false; // it uses the environment's counters
  uint32_t push_bytes = 0;
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkPipeline pipeline = VK_NULL_HANDLE;

  explicit Kernel(const Device& owner) : device(&owner) {}
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
};

struct TableBinding { // of descriptor set 1, in the buffer of the tables
  uint32_t binding = 0;
  VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  uint64_t offset = 0, bytes = 0;
};

struct EnvironmentTables::State {
  const Device& device;
  std::vector<TableBinding> bindings;
  uint64_t bytes = 0;
  VkBuffer buffer = VK_NULL_HANDLE;
  MemoryBlock memory;

  explicit State(const Device& owner) : device(owner) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
};

struct Environment {             // descriptor set 1
  uint64_t constants_bytes = 0;  // 0: binding 0 is no uniform buffer
  uint64_t constants_stride = 0; // from one frame in flight to the next
  uint64_t counters_bytes = 0;   // 0: no binding is counters
  uint64_t counters_offset = 0, counters_stride = 0;
  uint64_t total_bytes = 0;
  VkBuffer buffer = VK_NULL_HANDLE;
  MemoryBlock memory;
  std::byte* mapped = nullptr; // the constants of frame slot 0 come first
  VkSampler sampler = VK_NULL_HANDLE;
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE; // null: no environment
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets;                                    // by frame slot
  std::shared_ptr<const EnvironmentTables> tables;                      // that the next frame reads
  std::vector<std::shared_ptr<const EnvironmentTables>> tables_of_slot; // that `sets` point into
};

struct PortWrite { // one descriptor that every frame writes
  uint32_t pass = 0, port = 0;
  uint32_t placeholder =
      no_index; // into State::placeholders: where the port is not bound, or not in every frame
};

struct Descriptors { // sets 0, by frame slot and pass
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets; // [frame slot * passes + pass]; null for passes without kernel
  std::vector<PortWrite> ports;
  std::vector<VkWriteDescriptorSet> writes; // parallel to ports, pointing into the next two
  std::vector<VkDescriptorImageInfo> images;
  std::vector<VkDescriptorBufferInfo> buffers;
  std::vector<VkWriteDescriptorSetAccelerationStructureKHR> structures; // each points at one of `handles`
  std::vector<VkAccelerationStructureKHR> handles;
};

struct PortAccess {              // what stands at a port, into Plan::accesses
  uint32_t access = no_index;    // none: not bound
  uint32_t history = no_index;   // into State::histories: `access` counts only where this is valid
  uint32_t otherwise = no_index; // what stands there else; none: then it is not bound
};

struct Pass {
  std::string name;
  uint32_t kernel = no_index; // into State::kernels; none: clear, or the host's
  PassTypeId host;            // valid: the host records it
  uint32_t host_settings = 0; // that its pass type has
  std::vector<PortAccess> ports;
  uint32_t port_mask = 0;                      // ports that are bound in every frame
  std::vector<uint32_t> conditional_ports;     // the others that may be
  uint64_t indirect_entries = 1;               // that its indirect arguments have room for
  std::vector<uint32_t> writable_placeholders; // into State::placeholders
};

struct HistoryRecord {
  std::string name;
  bool written = false;                   // the plan writes the current instance
  bool scales = false;                    // the graph asks to rescale it, and the device can
  uint32_t first_rescale_view = no_index; // into Rescaling::views
  uint32_t first_rescale_set = no_index;  // into Rescaling::sets, of each frame slot
  uint32_t age = 0;
  HistoryReason reason = HistoryReason::first_frame;
  HistoryReason lost = HistoryReason::first_frame; // HistoryState::lost
};

struct Rescaling { // copies histories that an executor of another size kept
  std::array<std::shared_ptr<const Kernel>, 2> kernels; // float, unsigned; null: no history has the type
  // By history that scales and instance: a view of all mips to read, then one per mip to write.
  std::vector<VkImageView> views;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  std::vector<VkDescriptorSet> sets; // by frame slot, history that scales, frame and mip
  uint32_t sets_per_slot = 0;
};

struct Timestamps {
  VkQueryPool pool = VK_NULL_HANDLE;
  uint32_t per_frame = 0;              // passes + 1
  std::vector<uint64_t> frame_of_slot; // 0: nothing recorded there
  std::vector<uint64_t> ticks;         // room for reading one frame
  std::vector<uint64_t> kept;          // ticks of the newest frame whose queries were reused
  uint64_t kept_frame = 0;             // its index; 0: none
};

struct BeforeFrame { // what recording the last frame changed: see Executor::discard_frame
  struct History {
    uint32_t age = 0;
    HistoryReason reason = HistoryReason::first_frame;
    HistoryReason lost = HistoryReason::first_frame;
  };
  bool known = false;
  bool placeholders_ready = false;
  std::vector<History> histories; // by history
  std::vector<uint8_t> ready;     // by instance
  Rectangle previous_rectangle;
  uint64_t last_frame_index = 0;
};

struct Executor::State {
  const Device* device = nullptr;
  std::shared_ptr<const Plan> shared_plan;
  const Plan& plan;
  uint32_t frames_in_flight = 1;
  const HeapPool* heap_pool = nullptr; // or null
  std::vector<HeapMemory> heaps;
  std::vector<Instance> instances;
  std::vector<PartView> part_views;
  std::vector<uint32_t> view_of_access; // by plan access: first of its part_views, one for each instance;
                                        // no_index: all of the image, or no view
  std::vector<StandIn> placeholders;
  bool placeholders_ready = false;
  bool poison = false; // ExecutorInput::poison
  std::vector<std::shared_ptr<const Kernel>> kernels;
  Environment environment;
  Descriptors descriptors;
  std::vector<Pass> passes;
  std::vector<HistoryRecord> histories;
  Rescaling rescaling;
  std::vector<uint32_t>
      slot_resource; // by slot: into Plan::resources, no_index when the host does not bind it
  Timestamps timestamps;
  bool saw_lost_device = false;
  std::vector<VkImageMemoryBarrier2> image_barriers; // room for the largest batch
  std::vector<VkBufferMemoryBarrier2> buffer_barriers;
  std::vector<VkMemoryBarrier2> memory_barriers;
  std::vector<uint32_t> push_constants;
  const FunctionTable* commands = nullptr; // that the frame is recorded with
  HostPassFunction host_pass = nullptr;
  void* host_pass_user = nullptr;
  std::vector<HostPort> host_ports; // room for the largest call
  std::vector<SettingValue> host_settings;
  uint64_t frame_counter = 0; // frames recorded
  uint64_t last_frame_index = 0;
  std::vector<uint64_t> frame_of_slot; // frame_index recorded there last; 0: none
  Rectangle previous_rectangle;
  BeforeFrame before_frame;

  explicit State(std::shared_ptr<const Plan> from) : shared_plan(std::move(from)), plan(*shared_plan) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
};

using State = Executor::State;

// ---- memory.cpp
Error create_memory(State& state, const Graph& graph); // heaps, images, buffers, views
void destroy_memory(State& state);

// ---- placeholders.cpp
uint32_t placeholder_for(State& state, const KernelPort& port,
                         bool writes); // index; declares it if it is new
Error create_placeholders(State& state);
void destroy_placeholders(State& state);

// ---- environment.cpp
Error create_environment(State& state, std::span<const EnvironmentBinding> bindings,
                         const std::shared_ptr<const EnvironmentTables>& tables);
void destroy_environment(State& state);
uint64_t table_alignment(const Device& device); // of each binding's offset in a buffer
// Host-visible memory for set 1, zeroed; `buffer` and `memory` are the caller's to free, also on an error.
Error create_environment_buffer(const Device& device, uint64_t bytes, const char* name, VkBuffer& buffer,
                                MemoryBlock& memory);

// ---- environment_tables.cpp
bool is_table(size_t binding, const EnvironmentBinding& given); // its buffer is the same in every frame
// Set 1 of a frame slot that no frame in flight uses points into the newest tables.
void refresh_tables(State& state, uint32_t frame_slot) noexcept;
void clear_counters(State& state, uint32_t frame_slot) noexcept;
void write_frame_constants(State& state, uint32_t frame_slot, std::span<const std::byte> constants) noexcept;

// ---- kernels.cpp
Error create_kernels(State& state, const ExecutorInput& input);
// Creates `kernel.pipeline` from `kernel.layout`. `thing` names it in errors, `label` in debuggers.
Error create_pipeline(const Device& device, const std::string& subresource, const std::string& label,
                      std::span<const uint32_t> spirv, VkPipelineCache cache, Kernel& kernel);

// ---- history.cpp
void remember_before_frame(State& state) noexcept;
// What stands at the port in the frame that is being recorded: into Plan::accesses, or no_index.
uint32_t access_now(const State& state, const PortAccess& port) noexcept;

// ---- descriptors.cpp
Error create_descriptors(State& state, const PassTypeRegistry& pass_types);
void destroy_descriptors(State& state);
void write_descriptors(State& state, uint32_t frame_slot, const FrameInput& frame) noexcept;

// ---- barriers.cpp
// Which instance holds resource `r` of `frames_back` frames ago, in the frame that is being recorded.
uint32_t instance_of(const State& state, const PlanResource& resource, uint32_t frames_back) noexcept;
// One batch: the plan's barriers first .. first + count, and those that keep writes to stand-ins in order.
void record_barriers(State& state, const FrameInput& frame, uint32_t first, uint32_t count,
                     std::span<const uint32_t> writable_placeholders) noexcept;
// Everything before is done and visible: other commands used the same memory.
void record_memory_takeover(State& state, const FrameInput& frame) noexcept;
// What passes before counted is visible to this one, which counts as well.
void record_counters_in_order(State& state, const FrameInput& frame) noexcept;
// What kernels counted becomes visible to the host; nothing where they do not count.
void record_counters_to_host(State& state, const FrameInput& frame) noexcept;
void record_acquires(State& state, const FrameInput& frame) noexcept; // queue family transfers to us
void record_releases(State& state, const FrameInput& frame) noexcept; // and from us

// ---- history.cpp
// The history starts anew.
void forget(HistoryRecord& history, HistoryReason reason) noexcept;
// Every history starts anew at the next record.
void forget_histories(State& state, HistoryReason reason) noexcept;

// ---- carry.cpp
struct CarriedHistory {
  uint32_t history = no_index; // into the other's State::histories
  uint32_t age = 0;            // 0: nothing can be used
};
// What `from`, which recorded the frame before, keeps of history `index` of `to`: that of the same name and
// format, written by the same kind of pass; of another size where it is to be rescaled. `reset`: the camera
// cut.
CarriedHistory carried_history(const State& to, uint32_t index, const State& from, bool reset) noexcept;
// What the frame before covered, in pixels of `to`.
Rectangle carried_rectangle(const State& to, const State& from) noexcept;
void carry_ages(State& to, const State& from,
                bool reset) noexcept; // before anything is written for the frame
void record_carried(State& to, const State& from, VkCommandBuffer commands, uint32_t frame_slot,
                    bool reset) noexcept;

// ---- rescale.cpp
// Returns whether a history that `declaration` declares can be rescaled on the device.
bool can_rescale(const Device& device, const PlanResource& resource,
                 const HistoryDeclaration& declaration) noexcept;
Error create_rescaling(State& state, const ExecutorInput& input); // after create_memory
void destroy_rescaling(State& state);
struct RescaledHistory {
  uint32_t history = 0, source_history = 0; // into State::histories of both executors
  uint32_t frames_back = 1;
  uint32_t frame_slot = 0;
};
// Records the copy of one frame of a history. Both images are in the layout GENERAL.
void record_rescaling(State& to, const State& from, VkCommandBuffer commands,
                      const RescaledHistory& which) noexcept;

// ---- host_pass.cpp
Error check_host_passes(State& state, const ExecutorInput& input); // and makes room for their calls
SettingValue value_of(const State& state, const FrameInput& frame, const PlanPass& planned,
                      uint32_t index) noexcept;
void run_host_pass(State& state, const FrameInput& frame, size_t p, const Rectangle& rectangle) noexcept;

// ---- initialise.cpp
// Brings stand-ins and new or invalid history instances to zero and to the layout that the plan expects.
void record_initialisation(State& state, VkCommandBuffer commands) noexcept;

// ---- poison.cpp
// Does nobody read what was there before this barrier?
bool discards(const Plan& plan, const PlanBarrier& barrier) noexcept;
// The barrier `image` or `buffer` in two halves, and what is filled between them.
void record_poison(State& state, VkCommandBuffer commands, const VkImageMemoryBarrier2& image,
                   Format format) noexcept;
void record_poison(State& state, VkCommandBuffer commands, const VkBufferMemoryBarrier2& buffer) noexcept;

// ---- timestamps.cpp
Error create_timestamps(State& state);
void begin_timestamps(State& state, VkCommandBuffer commands, uint32_t frame_slot) noexcept;
void write_timestamp(State& state, VkCommandBuffer commands, uint32_t frame_slot, uint32_t index) noexcept;

} // namespace dermis::vulkan
