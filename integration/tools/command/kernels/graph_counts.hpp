#pragma once
// Counts what one frame of a graph's plan does: dispatches, barrier calls, and bytes per pixel.

#include "framegraph/compile/compile.hpp"
#include "framegraph/explain/traffic.hpp"
#include "framegraph/vulkan/executor.hpp"
#include "integration/tools/null_device/null_device.hpp"

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

struct PassCounts {
  std::string pass, kernel; // names; no kernel: ""
  PassTraffic traffic;
  std::string constants{}; // of the pass's pipeline, as in KernelRow
};

struct GraphCounts {
  std::string graph;                        // file name without folder and ".json"
  uint32_t configurations = 0;              // combinations of settings whose pipelines are listed
  uint32_t pipelines = 0;                   // of all configurations
  uint64_t dispatches = 0, barriers = 0;    // calls per frame; barriers: vkCmdPipelineBarrier2
  double read_bytes = 0, written_bytes = 0; // per covered pixel
  std::vector<PassCounts> passes;

  // Returns the value with that name in limits files; nullopt for an unknown name.
  std::optional<double> value(std::string_view key) const;
  static std::span<const std::string_view> keys();
};

// A device that only counts. Records plans as an engine would, without a driver.
class CountingDevice {
public:
  CountingDevice();

  // The device profile of this device, with the features and formats of `real`, which must outlive
  // the result.
  DeviceProfile profile_for(const vulkan::Device& real) const;

  // Records a frame in a steady state: histories are valid, and the host binds every slot of the
  // plan. Returns the problem, or "".
  std::string count_commands(const Graph& graph, const PassTypeRegistry& pass_types,
                             const Plan& plan, std::span<const vulkan::KernelCode> kernels,
                             std::span<const vulkan::EnvironmentBinding> environment,
                             GraphCounts& counts);

private:
  NullDevice null_;
  vulkan::Device device_;
};

// Adds names and traffic of the plan's passes to `counts`, for a frame in which tiles scatter.
void count_bytes(const Graph& graph, const PassTypeRegistry& pass_types, const Plan& plan,
                 const TrafficAssumptions& assumptions, GraphCounts& counts);

} // namespace dermis::tools
