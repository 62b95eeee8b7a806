#pragma once
// Compiles the kernels of a plan and reads what the driver reports about the generated code.
// Creates pipelines and their layouts only: no memory, image, buffer or command. Drivers that
// compile for absent hardware can do no more.

#include "framegraph/vulkan/executor.hpp"
#include "framegraph/vulkan/kernel_store.hpp"

namespace dermis::vulkan {

struct PipelineStatistic {
  std::string name, description; // as the driver reports them
  double value = 0;              // a boolean is 0 or 1
};

// One program that the driver compiled for a pipeline. Some drivers compile several programs per
// pipeline, one per subgroup size.
struct PipelineExecutable {
  std::string name;
  uint32_t subgroup_size = 0; // 0: the driver does not report it
  std::vector<PipelineStatistic> statistics;
  std::string assembly; // "": not requested, or the driver has none
};

struct CompiledPipeline {
  std::shared_ptr<const Pipeline> pipeline; // equal for equal pipelines of one KernelStore
  PassTypeId type;
  // Values of its specialisation constants, such as "storage=half variant=smooth guide=bound". A
  // port is bound, unbound or changing; "": the kernel has no constants.
  std::string constants;
  std::vector<uint32_t> passes;                // positions in Plan::passes
  std::vector<PipelineExecutable> executables; // empty: see PipelinesInput::statistics
};

// All pointers are required and must outlive the call. `device` must outlive the results.
struct PipelinesInput {
  const Device* device = nullptr;
  const PassTypeRegistry* pass_types = nullptr;
  const Plan* plan = nullptr;
  std::span<const KernelCode> kernels;
  std::span<const EnvironmentBinding> environment; // sizes and types; contents are not used
  // VK_KHR_pipeline_executable_properties and its feature are enabled
  bool statistics = false;
  bool assembly = false;        // also read the generated assembly; needs `statistics`
  KernelStore* store = nullptr; // keeps the pipelines; each is compiled once
};

// Adds one entry per pipeline of the plan, in plan order. Errors: as Executor::create. May throw
// std::bad_alloc. Free-threaded.
Error compile_pipelines(const PipelinesInput& input, std::vector<CompiledPipeline>& pipelines);

} // namespace dermis::vulkan
