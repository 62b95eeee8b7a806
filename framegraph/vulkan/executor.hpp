#pragma once
// Runs a Plan on the host's device: owns its images, buffers, memory, pipelines, descriptors and
// queries, and records frames into the host's command buffers. One executor serves one view and
// owns that view's histories.

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

// Describes one compiled kernel: `shader` is PassType::shader, the entry point is "main".
struct KernelCode {
  std::string_view shader;
  std::span<const uint32_t> spirv;
  uint64_t version = 0; // kernels with equal name and version are equal
};

// Describes descriptor set 1, common to all kernels: entry i is binding i. Binding 0, if it is a
// uniform buffer, holds the frame constants. Frame constants and counters exist once per frame in
// flight; all other buffers are written once.
enum class EnvironmentType : uint8_t {
  uniform_buffer,
  storage_buffer,
  linear_sampler,
  // counters: a storage buffer that kernels write and the host reads; zero at the start of each
  // frame
  counters
};
struct EnvironmentBinding {
  EnvironmentType type = EnvironmentType::uniform_buffer;
  uint64_t bytes = 0; // size of the buffer, at least 1; counters: a multiple of 4
  // at most `bytes`; the rest is zero; ignored for frame constants
  std::span<const std::byte> contents{};
};

// Holds the static buffers of an environment: all except frame constants, counters and samplers.
// The memory is host-visible, and device-local if the device has memory that is both. All views of
// an environment share the tables.
class EnvironmentTables {
public:
  // Creates tables. `device` must outlive them. Errors: host_memory, device_memory, device_lost,
  // vulkan; `tables` is then unchanged. May throw std::bad_alloc. Free-threaded.
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

// The tables as the kernels of one view read them: `source` itself if that is device-local,
// otherwise a copy in device-local memory, which the first recorded frame fills. Shared by the
// executors of one view, whose frames must run in the order in which they were recorded. Lives as
// long as an executor, or a frame in flight, uses it.
class ViewTables {
public:
  // Creates tables. The device of `source` must outlive them. Errors: as EnvironmentTables;
  // `tables` is then unchanged. May throw std::bad_alloc. Free-threaded.
  static Error create(std::shared_ptr<const EnvironmentTables> source,
                      std::shared_ptr<ViewTables>& tables);
  ~ViewTables();
  uint64_t bytes() const noexcept; // of device memory for the copy; 0: no copy

  ViewTables(const ViewTables&) = delete;
  ViewTables& operator=(const ViewTables&) = delete;
  struct State; // internal
  State& state() noexcept { return *state_; }

private:
  explicit ViewTables(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// States why the contents of a history are invalid.
enum class HistoryReason : uint8_t {
  valid,       // the history is valid
  first_frame, // nothing has been recorded yet
  cut,         // FrameInput::reset_history
  resized,     // the executor was made for a new size
  reloaded,    // the executor was made for a new graph
  switched,    // frames ran with another plan
  left_out     // a frame ran without some passes: FrameInput::left_out
};
// Returns a static human-readable string, e.g. "camera cut". Free-threaded.
const char* history_reason_text(HistoryReason reason);
// Returns the text for a history that is valid again, e.g. "valid since a camera cut". `lost` is
// why it was last invalid. Free-threaded.
const char* valid_since_text(HistoryReason lost);

class HeapPool;
class KernelStore;
class Executor;
struct PlanPipelines; // internal: the pipelines of a plan

struct Rectangle { // pixels, inside the allocated view size.
  uint32_t x = 0, y = 0, width = 0, height = 0;
};

// Describes the resource bound to a port of a host-recorded pass: an image, a buffer or an
// acceleration structure. All handles are null if nothing is bound.
struct HostPort {
  VkImage image = VK_NULL_HANDLE;
  VkImageView view = VK_NULL_HANDLE; // of the port's range; storage images: one mip
  VkFormat format = VK_FORMAT_UNDEFINED;
  // current layout; the pass must leave the image in it
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  uint32_t width = 0, height = 0; // pixels, of the view's first mip
  VkBuffer buffer = VK_NULL_HANDLE;
  uint64_t offset = 0, bytes = 0; // of the buffer; offset is 0 except in the host's buffers
  VkAccelerationStructureKHR structure = VK_NULL_HANDLE;
};

// Describes one call of a host-recorded pass. Everything is valid until the call returns.
struct HostPass {
  PassTypeId type;
  const char* pass = ""; // name
  VkCommandBuffer command_buffer = VK_NULL_HANDLE;
  std::span<const HostPort> ports;        // by PassType::ports
  std::span<const SettingValue> settings; // by PassType::settings
  Rectangle rectangle;                    // area to render
  uint64_t frame_index = 0;
  void* view_user = nullptr; // FrameInput::view_user
};

// Records passes of the host, between the plan's barriers. Must not throw.
using HostPassFunction = void (*)(void* user, const HostPass& call);

// Input of Executor::create. `device` and `heap_pool` must outlive the executor. Shared pointers
// are shared; everything else is copied or consumed during the call.
struct ExecutorInput {
  const Device* device = nullptr; // must outlive the executor
  const Graph* graph = nullptr;   // the plan's graph; provides names
  const PassTypeRegistry* pass_types = nullptr;
  const Plan* plan = nullptr;                      // compiled with device_profile(*device)
  std::span<const KernelCode> kernels;             // at least those of the plan's pass types
  std::span<const EnvironmentBinding> environment; // may be empty
  // made from `environment`; null: the executor makes its own
  std::shared_ptr<ViewTables> tables = nullptr;
  uint32_t frames_in_flight = 2;                   // 1 to max_frames_in_flight
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE; // may be null
  // Must have been made for a set of plans that includes the one at `kept_plan`. No other user of
  // the pool may run at the same time. Null: the executor allocates its own memory.
  const HeapPool* heap_pool = nullptr;
  // equal to `plan`, shared from now on; null: `plan` is copied
  std::shared_ptr<const Plan> kept_plan = nullptr;
  // null: the executor compiles all kernels itself
  KernelStore* kernel_store = nullptr;
  // Values that FrameInput::settings may have, one per Graph::settings each: the executor creates
  // their pipelines. Settings that are not constants of kernels may also differ. Empty: only the
  // plan's values.
  std::span<const std::vector<SettingValue>> settings{};
  HistoryReason history = HistoryReason::first_frame; // why histories start invalid
  // required if the plan has host-recorded passes; called by record()
  HostPassFunction host_pass = nullptr;
  void* host_pass_user = nullptr;
  // For tests: each frame fills all undefined memory with NaN, or with 0xCD in each byte, before
  // its first write. The plan must be compiled with CompileInput::poison.
  bool poison = false;
};

struct HostState {
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  // the executor's own family or IGNORED: no ownership transfer
  uint32_t queue_family = VK_QUEUE_FAMILY_IGNORED;
  VkPipelineStageFlags2 stages = 0;
  VkAccessFlags2 access = 0;
};

// Describes the image that the host binds to slot i (PlanResource::slot). A queue family transfer
// keeps the layout. The host releases to the executor's family, or acquires from it, with both
// layouts set to before.layout or after.layout respectively.
struct HostImage {
  VkImage image = VK_NULL_HANDLE; // null: not bound
  VkImageView view = VK_NULL_HANDLE;
  HostState before, after;
  // layers of the image that barriers apply to; 0 layers: all from first_layer
  uint32_t first_layer = 0, layers = 0;
  // Handles alone do not identify an object, because Vulkan reuses them. If ids and handles of two
  // frames are equal, so are the image and its view, and their descriptors are not rewritten.
  // content_id 0: not known; descriptors are always rewritten.
  uint64_t content_id = 0, view_id = 0;
};

// Describes a buffer range of the host. HostState::layout is ignored.
struct HostBuffer {
  VkBuffer buffer = VK_NULL_HANDLE; // null: not bound
  VkDeviceSize offset = 0, bytes = 0;
  HostState before, after;
};

// Describes an acceleration structure of the host. Its barriers cover all memory, because only the
// host knows the structure's bottom level. Queue families are IGNORED.
struct HostStructure {
  VkAccelerationStructureKHR structure = VK_NULL_HANDLE; // null: not bound
  HostState before, after;
};

struct FrameInput {
  // Must be in the recording state, outside a render pass, and of Device::queue_family.
  VkCommandBuffer command_buffer = VK_NULL_HANDLE;
  std::span<const HostImage> images;          // by slot number; slots beyond the end are not bound
  std::span<const HostBuffer> buffers;        // by slot number, as for images
  std::span<const HostStructure> structures;  // by slot number, as for images
  std::span<const std::byte> frame_constants; // for set 1 binding 0; at most its size
  // one per Graph::settings; empty: the plan's values; see ExecutorInput::settings
  std::span<const SettingValue> settings;
  Rectangle rectangle; // width 0: the allocated view size
  // must increase; frame `frame_index - frames_in_flight` must be finished
  uint64_t frame_index = 1;
  // True: other plans recorded frames since the last record, so the pool's memory was overwritten.
  // All histories restart, except those that `before` holds.
  bool memory_overwritten = false;
  // The executor that recorded the previous frame with another plan: of this graph, or of the graph
  // before a reload or resize. Histories that both have are copied from it. It must live until the
  // device has finished this frame.
  const Executor* before = nullptr;
  bool reset_history = false; // camera cut: invalidates histories with on_cut invalidate
  // By plan pass; nonzero: the pass does not run, and only its barriers are recorded. Histories
  // that it writes restart in the next frame. Passes beyond the end run. A pass that runs must not
  // read what a left-out pass would write.
  std::span<const uint8_t> left_out;
  void* view_user = nullptr; // passed to host-recorded passes
  // For hosts that capture commands instead of filling a command buffer: the vkCmd... functions of
  // `commands` are called with `command_buffer`, and host-recorded passes call `host_pass`. Null:
  // the device's functions and the executor's host_pass.
  const FunctionTable* commands = nullptr;
  HostPassFunction host_pass = nullptr;
  void* host_pass_user = nullptr;
};

// Describes an error like Error, but owns no memory.
struct RecordResult {
  ErrorKind kind = ErrorKind::none;
  VkResult result = VK_SUCCESS;
  const char* text = ""; // static
  int32_t slot = -1;     // slot the error is about; -1: none

  explicit operator bool() const { return kind != ErrorKind::none; } // true: there is an error
};

struct HistoryState {
  std::string_view resource; // lives as long as the executor
  bool valid = false;        // `@-1` holds what the previous frame wrote
  uint32_t age = 0;          // number of consecutive frames held; `@-N` is valid if age >= N
  HistoryReason reason = HistoryReason::first_frame;
  HistoryReason lost = HistoryReason::first_frame; // reason of its last invalidation; never `valid`
};

struct PassTiming {
  std::string_view pass; // name; lives as long as the executor
  uint64_t nanoseconds = 0;
};

class Executor {
public:
  // Creates an executor and allocates everything that a frame needs. Errors: argument, unsupported,
  // shader, host_memory, device_memory, device_lost, vulkan; everything is then released and
  // `executor` is unchanged. May throw std::bad_alloc. Free-threaded.
  static Error create(const ExecutorInput& input, std::unique_ptr<Executor>& executor);
  // The device must have finished every recorded frame.
  ~Executor();

  // Records the whole plan. On an error nothing is recorded and nothing changes. Allocates no host
  // memory, throws nothing, and never submits or waits. One thread at a time per executor.
  RecordResult record(const FrameInput& frame) noexcept;

  // Creates the pipelines of the plan for other values of settings. Uses pass_types, kernels,
  // pipeline_cache, kernel_store and settings of `input`; the first four must be those of create().
  // Another thread may record meanwhile. Errors: as create(); `pipelines` is then unchanged. May
  // throw std::bad_alloc.
  Error make_pipelines(const ExecutorInput& input,
                       std::shared_ptr<const PlanPipelines>& pipelines) const;
  // Makes the next recorded frame use `pipelines`, which this executor made. Frames in flight keep
  // theirs. One thread at a time per executor.
  void set_pipelines(const std::shared_ptr<const PlanPipelines>& pipelines) noexcept;
  // Releases pipelines that only frames up to `completed_frame_index` use. One thread at a time per
  // executor.
  void release_pipelines(uint64_t completed_frame_index) noexcept;

  // Makes the next recorded frame read `tables`, which must have the same bindings as the tables
  // before. Frames in flight keep the tables that they were recorded with. One thread at a time per
  // executor.
  void set_tables(const std::shared_ptr<ViewTables>& tables) noexcept;
  // Releases tables that only frames up to `completed_frame_index` read. One thread at a time per
  // executor.
  void release_tables(uint64_t completed_frame_index) noexcept;

  // Returns the state of history `index` (Plan::histories) that the next recorded frame will see.
  // `reset_history` and `before` must have that frame's values. One thread at a time per executor.
  HistoryState history_state(uint32_t index, bool reset_history = false,
                             const Executor* before = nullptr) const noexcept;
  uint32_t history_count() const noexcept;
  // Returns the rectangle of the last recorded frame, which is the area that histories cover. With
  // `before`, returns the rectangle of that executor in pixels of this plan's view. Width 0: no
  // frame yet.
  Rectangle previous_rectangle(const Executor* before = nullptr) const noexcept;
  // Undoes the last recorded frame, which was not submitted and never will be. Returns false if the
  // last frame is not `frame_index` or was already discarded. One thread at a time per executor.
  bool discard_frame(uint64_t frame_index) noexcept;
  // Undoes the last recorded frame as if record() had failed: the frame before it can be discarded
  // again. One thread at a time per executor.
  void undo_last_record(uint64_t frame_index) noexcept;

  // Reads the device time of each pass, in plan order, of the newest recorded frame <=
  // completed_frame_index. Writes its index to `frame_index` and one entry per plan pass to
  // `timings`. Returns false if no result is ready or timings are disabled. One thread at a time
  // per executor.
  bool read_timings(uint64_t completed_frame_index, uint64_t& frame_index,
                    std::span<PassTiming> timings) noexcept;

  // Copies the counters of frame `frame_index`, which the device must have finished: as many words
  // as fit. Returns false if the frame was not recorded here or its memory has been reused. One
  // thread at a time per executor.
  bool read_counters(uint64_t frame_index, std::span<uint32_t> counters) const noexcept;
  // Returns whether reading timings reported a lost device. One thread at a time per executor.
  bool saw_lost_device() const noexcept;
  const Plan& plan() const noexcept;
  // Returns the device memory request of heap `index` (Plan::heaps); 0 bytes: the heap uses the
  // pool. Throws nothing.
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
