#pragma once
// Runs a Plan on the host's device: owns its images, buffers, memory, pipelines, descriptors and queries, and
// records frames into command buffers of the host. One executor is one view: it owns that view's history.

#include "framegraph/compile/plan.hpp"
#include "framegraph/vulkan/device.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::vulkan {

inline constexpr uint32_t max_frames_in_flight = 8;

// One compiled kernel: `shader` is PassType::shader, the entry point is "main".
struct KernelCode {
  std::string_view shader;
  std::span<const uint32_t> spirv;
  uint64_t version = 0; // kernels of one name and version are the same
};

// Descriptor set 1, common to all kernels: entry i is binding i. Binding 0, if it is a uniform buffer, holds
// the frame constants and exists once per frame in flight, as counters do; the others are written once.
enum class EnvironmentType : uint8_t {
  uniform_buffer,
  storage_buffer,
  linear_sampler,
  counters // storage buffer that kernels write and the host reads; zero at the start of each frame
};
struct EnvironmentBinding {
  EnvironmentType type = EnvironmentType::uniform_buffer;
  uint64_t bytes = 0;                    // of the buffer, 1 or more; counters: a multiple of 4
  std::span<const std::byte> contents{}; // at most `bytes`, the rest is zero; ignored for frame constants
};

// The static buffers of an environment on the device: all but frame constants, counters and samplers.
// Executors of one environment share them; they live as long as one of these, or a frame in flight, uses
// them.
class EnvironmentTables {
public:
  // `device` must outlive the tables. Errors: host_memory, device_memory, device_lost, vulkan; `tables` is
  // then unchanged. May throw std::bad_alloc. Free-threaded.
  static Error create(const Device& device, std::span<const EnvironmentBinding> environment,
                      std::shared_ptr<const EnvironmentTables>& tables);
  ~EnvironmentTables();
  uint64_t bytes() const noexcept; // of device memory

  EnvironmentTables(const EnvironmentTables&) = delete;
  EnvironmentTables& operator=(const EnvironmentTables&) = delete;
  struct State; // internal
  const State& state() const noexcept { return *state_; }

private:
  explicit EnvironmentTables(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Why a history holds nothing worth reading.
enum class HistoryReason : uint8_t {
  valid,       // it does
  first_frame, // nothing has been recorded yet
  cut,         // FrameInput::reset_history
  resized,     // the executor was made for a new size
  reloaded,    // the executor was made for a new graph
  switched,    // frames ran with another plan
  left_out     // a frame ran without passes: FrameInput::left_out
};
// Static string for people, for example "camera cut". Free-threaded.
const char* history_reason_text(HistoryReason reason);
// The same for a history that holds something again since then: "valid since a camera cut".
const char* valid_since_text(HistoryReason lost);

class HeapPool;
class KernelStore;
class Executor;

struct Rectangle { // pixels; inside the allocated view size
  uint32_t x = 0, y = 0, width = 0, height = 0;
};

// What stands at a port of a pass that the host records: image, buffer or acceleration structure; all null
// where nothing is bound.
struct HostPort {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE; // of the part that the port names; storage images: of one mip
  VkFormat format = VK_FORMAT_UNDEFINED;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED; // that the image is in, and must be left in
  uint32_t width = 0, height = 0;                   // of the view's first mip
  VkBuffer buffer = VK_NULL_HANDLE;
  uint64_t offset = 0, bytes = 0; // of it; the offset is not 0 in buffers of the host alone
  VkAccelerationStructureKHR structure = VK_NULL_HANDLE;
};

// One call of a host's pass. Everything lives until the call returns.
struct HostPass {
  PassTypeId type;
  const char* pass = ""; // name
  VkCommandBuffer command_buffer = VK_NULL_HANDLE;
  std::span<const HostPort> ports;        // by PassType::ports
  std::span<const SettingValue> settings; // by PassType::settings
  Rectangle rectangle;                    // that is rendered
  uint64_t frame_index = 0;
  void* view_user = nullptr; // FrameInput::view_user
};

// Records passes whose kind has DispatchShape::host, between the plan's barriers. Must not throw.
using HostPassFunction = void (*)(void* user, const HostPass& call);

struct ExecutorInput { // nothing is kept but `device`; all the rest is copied or consumed during the call
  const Device* device = nullptr; // must outlive the executor
  const Graph* graph = nullptr;   // that the plan was compiled from: names
  const PassTypeRegistry* pass_types = nullptr;
  const Plan* plan = nullptr;                      // compiled with device_profile(*device)
  std::span<const KernelCode> kernels;             // at least those of the plan's pass types
  std::span<const EnvironmentBinding> environment; // may be empty
  std::shared_ptr<const EnvironmentTables> tables =
      nullptr;                   // made from `environment`; null: the executor makes them for itself
  uint32_t frames_in_flight = 2; // 1 .. max_frames_in_flight
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE; // may be null
  const HeapPool* heap_pool = nullptr; // made with this plan among others: transients lie in its memory, and
                                       // no other user of it may run at the same time. Null: its own memory.
  std::shared_ptr<const Plan> kept_plan =
      nullptr;                         // the same as `plan`, shared from now on; null: it is copied
  KernelStore* kernel_store = nullptr; // null: the executor compiles all kernels for itself
  HistoryReason history = HistoryReason::first_frame; // why histories start invalid
  HostPassFunction host_pass =
      nullptr; // needed where the plan has passes that the host records; called by record()
  void* host_pass_user = nullptr;
  // For tests: each frame fills whatever the plan says nobody may read, before it is first written, with NaN,
  // or 0xCD in each byte. The plan must be compiled with CompileInput::poison.
  bool poison = false;
};

struct HostState {
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  uint32_t queue_family = VK_QUEUE_FAMILY_IGNORED; // the executor's own or IGNORED: no ownership transfer
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 access = 0;
};

// What the host binds to slot i (PlanResource::slot). A queue family transfer keeps the layout: the host
// releases to the executor's family, or acquires from it, with old and new layout both before.layout, or both
// after.layout.
struct HostImage {
  VkImage image = VK_NULL_HANDLE; // null: not bound
  VkImageView view = VK_NULL_HANDLE;
  HostState before, after;
  // Of the image, that the barriers are about; 0 layers: all from the first.
  uint32_t first_layer = 0, layers = 0;
};

// Buffer of the host: `bytes` of it from `offset`. HostState::layout means nothing.
struct HostBuffer {
  VkBuffer buffer = VK_NULL_HANDLE; // null: not bound
  VkDeviceSize offset = 0, bytes = 0;
  HostState before, after;
};

// The barriers are about all memory: what lies below the top level is the host's to know. Queue families are
// IGNORED.
struct HostStructure {
  VkAccelerationStructureKHR structure = VK_NULL_HANDLE; // null: not bound
  HostState before, after;
};

struct FrameInput {
  VkCommandBuffer command_buffer =
      VK_NULL_HANDLE;                         // recording, outside a render pass, of Device::queue_family
  std::span<const HostImage> images;          // by slot number; shorter: the rest is not bound
  std::span<const HostBuffer> buffers;        // likewise
  std::span<const HostStructure> structures;  // likewise
  std::span<const std::byte> frame_constants; // for set 1 binding 0; at most its bytes
  std::span<const SettingValue> settings;     // one per Graph::settings; empty: those of the plan
  Rectangle rectangle;                        // width 0: the allocated view size
  uint64_t frame_index = 1;                   // grows; the frame `frame_index - frames_in_flight` is finished
  bool taken_over = false; // frames ran elsewhere since the last record: the pool's memory was used by
                           // others, and histories start anew but for what `before` kept
  const Executor* before = nullptr; // recorded the frame before, another plan of the graph, or of what the
                                    // graph was before it was reloaded or resized. What both keep is copied
                                    // from it; it must live until the device has finished this frame
  bool reset_history = false;       // camera cut: histories with on_cut invalidate become invalid
  // By plan pass, not 0: the pass does not run, only its barriers are recorded. Histories that it writes
  // start anew in the frame after such a one. Shorter: the rest runs. What runs must not read what a pass
  // that is left out would write.
  std::span<const uint8_t> left_out;
  void* view_user = nullptr; // handed to passes of the host
  // For whoever wants the commands and no command buffer: its vkCmd... functions are called with
  // `command_buffer` instead of the device's, and passes of the host go to this function. Null: the device's,
  // the executor's.
  const FunctionTable* commands = nullptr;
  HostPassFunction host_pass = nullptr;
  void* host_pass_user = nullptr;
};

// Like Error, without memory of its own.
struct RecordResult {
  ErrorKind kind = ErrorKind::none;
  VkResult result = VK_SUCCESS;
  const char* text = ""; // static
  int32_t slot = -1;     // that the error is about; -1: none

  explicit operator bool() const { return kind != ErrorKind::none; } // true: there is an error
};

struct HistoryState {
  std::string_view resource; // lives as long as the executor
  bool valid = false;        // `@-1` holds what the frame before this one wrote
  uint32_t age = 0;          // number of consecutive frames it holds; `@-N` is valid when age >= N
  HistoryReason reason = HistoryReason::first_frame;
  HistoryReason lost = HistoryReason::first_frame; // why it held nothing when it last did; never `valid`
};

struct PassTiming {
  std::string_view pass; // name; lives as long as the executor
  uint64_t nanoseconds = 0;
};

class Executor {
public:
  // Everything a frame needs is allocated here. Errors: argument, unsupported, shader, host_memory,
  // device_memory, device_lost, vulkan; nothing is left behind and `executor` is unchanged. May throw
  // std::bad_alloc. Free-threaded.
  static Error create(const ExecutorInput& input, std::unique_ptr<Executor>& executor);
  // The device must have finished every recorded frame.
  ~Executor();

  // Records the whole plan. On an error nothing was recorded and nothing changed. Never allocates host memory
  // of its own, never throws, submits or waits. One thread at a time per executor.
  RecordResult record(const FrameInput& frame) noexcept;

  // The next recorded frame reads `tables`, which have the bindings of those before; frames in flight keep
  // what they were recorded with. One thread at a time per executor.
  void set_tables(const std::shared_ptr<const EnvironmentTables>& tables) noexcept;
  // Lets go of tables that only frames up to `completed_frame_index` read. One thread at a time per executor.
  void release_tables(uint64_t completed_frame_index) noexcept;

  // State of history `index` (Plan::histories) as the next recorded frame sees it; give `reset_history` as
  // that frame will. One thread at a time per executor.
  HistoryState history_state(uint32_t index, bool reset_history = false,
                             const Executor* before = nullptr) const noexcept;
  uint32_t history_count() const noexcept;
  // Rectangle of the frame recorded last, or of that of `before` in pixels of this plan's view; that is what
  // histories cover. Width 0: none yet.
  Rectangle previous_rectangle(const Executor* before = nullptr) const noexcept;
  // The frame recorded last was not submitted and never will be: everything is as it was before. False: it is
  // not `frame_index`, or was taken back already. One thread at a time per executor.
  bool discard_frame(uint64_t frame_index) noexcept;

  // Device time of each pass, in plan order, of the newest recorded frame <= completed_frame_index; it is
  // written to `frame_index` and `timings` (one per plan pass). False: none ready, or no timings asked for.
  // One thread at a time per executor.
  bool read_timings(uint64_t completed_frame_index, uint64_t& frame_index,
                    std::span<PassTiming> timings) noexcept;

  // What kernels counted in frame `frame_index`, which the device has finished: as many as fit of the words
  // of the environment's counters. False: that frame was not recorded here, or another took its place since.
  // One thread at a time per executor.
  bool read_counters(uint64_t frame_index, std::span<uint32_t> counters) const noexcept;
  // Reading times told that the device is lost. One thread at a time per executor.
  bool saw_lost_device() const noexcept;
  const Plan& plan() const noexcept;
  // Device memory that it took for heap `index` (Plan::heaps); bytes 0: it lies in the pool. Throws nothing.
  MemoryRequest heap_request(uint32_t index) const noexcept;
  uint64_t constant_bytes() const noexcept; // device memory for set 1, without the tables

  Executor(const Executor&) = delete;
  Executor& operator=(const Executor&) = delete;
  struct State; // internal

private:
  explicit Executor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

} // namespace dermis::vulkan
