#pragma once
// Kernels and the pipelines that are compiled from them. Internal to vulkan/executor/.

#include "framegraph/vulkan/executor.hpp"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::vulkan {

inline constexpr uint32_t no_index = 0xffffffffu;

struct KernelPort {
  std::optional<VkDescriptorType> type;
  VkFormat placeholder = VK_FORMAT_UNDEFINED; // image format to bind if the port is unbound
};

// Specialisation constant that a kernel declares.
struct KernelConstant {
  uint32_t id = 0;             // see constant_id
  uint32_t setting = no_index; // into PassType::settings; no_index: of the plan
};

// One per pass type that dispatches; shared by the executors that run it.
struct Kernel {
  const Device* device = nullptr;
  PassTypeId type;
  uint64_t version = 0; // KernelCode::version
  DispatchRule dispatch = {};
  uint32_t indirect_port = no_index;
  // setting that selects the entry of the indirect arguments; no_index: entry 0
  uint32_t entry_setting = no_index;
  std::vector<KernelPort> ports;
  bool counts = false; // true: uses the environment's counters
  uint32_t push_bytes = 0;
  std::vector<uint32_t> pushed_settings; // into PassType::settings
  std::vector<KernelConstant> constants;
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;

  explicit Kernel(const Device& owner) : device(&owner) {}
  ~Kernel();
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;
};

// A kernel compiled for one value of each of its constants; shared like the kernel.
struct Pipeline {
  std::shared_ptr<const Kernel> kernel;
  std::vector<uint32_t> constants; // by Kernel::constants
  VkPipeline handle = VK_NULL_HANDLE;

  explicit Pipeline(std::shared_ptr<const Kernel> of) : kernel(std::move(of)) {}
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;
};

// The pipelines of a plan, for all values that the settings of a frame may have.
struct PlanPipelines {
  std::vector<std::shared_ptr<const Pipeline>> all; // each once
  // by plan pass: into `all`, one per combination of constants
  std::vector<std::vector<uint32_t>> of_pass;
};

// Ports of a pass, bit i for port i.
struct PortMasks {
  uint32_t bound = 0;    // in every frame
  uint32_t changing = 0; // in some frames: those in which a history is valid
};
PortMasks port_masks(const Plan& plan, const PlanPass& pass);
// Returns setting `index` of a pass in frames with `settings` (empty: the plan's values).
SettingValue value_of(const Plan& plan, const PlanPass& pass, uint32_t index,
                      std::span<const SettingValue> settings) noexcept;
// Returns a setting's value as kernels read it.
uint32_t kernel_word(const SettingValue& value);
// Describes what the kernels of plans are created from.
struct KernelInput {
  const Device& device;
  const PassTypeRegistry& pass_types;
  std::span<const KernelCode> codes;
  std::span<const EnvironmentBinding> environment;
  VkDescriptorSetLayout environment_layout = VK_NULL_HANDLE; // null: no environment
  VkPipelineCache cache = VK_NULL_HANDLE;                    // may be null
  VkPipelineCreateFlags flags = 0;
  KernelStore* store = nullptr; // null: the kernels are shared with no other plan
  std::span<const std::vector<SettingValue>> settings{}; // ExecutorInput::settings
};
struct PlanKernels {
  std::vector<std::shared_ptr<const Kernel>> kernels;
  std::vector<uint32_t> of_pass; // by plan pass: into `kernels`; no_index: the pass has no kernel
};
// Creates the kernels of a plan, without pipelines. Needs no memory, image or buffer of the device.
Error create_kernels(const KernelInput& input, const Plan& plan, PlanKernels& made);
// Creates the pipelines of a plan's kernels. Equal kernels with equal constants share a pipeline.
Error create_pipelines(const KernelInput& input, const Plan& plan, const PlanKernels& kernels,
                       PlanPipelines& made);
struct PipelineOptions {
  VkPipelineCache cache = VK_NULL_HANDLE;
  VkPipelineCreateFlags flags = 0;
};
// Creates `pipeline.handle` for its kernel and constants. `object` names it in errors, `label`
// in debuggers.
Error create_pipeline(const Device& device, const std::string& object, const std::string& label,
                      std::span<const uint32_t> spirv, const PipelineOptions& options,
                      Pipeline& pipeline);

} // namespace dermis::vulkan
