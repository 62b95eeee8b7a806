#pragma once
// One row per program that a driver compiled for a kernel: the statistics of all drivers under
// common names.

#include "framegraph/vulkan/pipeline_statistics.hpp"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

enum class KernelValue : uint8_t {
  vgprs,         // vector registers per invocation
  sgprs,         // scalar registers per subgroup
  spilled_vgprs, // vector registers kept in memory
  spilled_sgprs, // scalar registers kept in vector registers or memory
  scratch_bytes, // private memory, in the driver's unit (RADV: bytes per subgroup)
  shared_bytes,  // shared memory of a workgroup
  occupancy,     // subgroups per SIMD (RADV from GFX10 on: in equivalents of 32 invocations)
  subgroup_size,
  code_bytes,
  instructions,
  count
};
inline constexpr size_t kernel_value_count = static_cast<size_t>(KernelValue::count);

struct KernelValueInfo {
  std::string_view key;   // in files: "spilled_vgprs"
  std::string_view title; // of the column: "spilled VGPRs"
};
std::span<const KernelValueInfo> kernel_values(); // by KernelValue
std::optional<KernelValue> find_kernel_value(std::string_view key);

struct KernelRow {
  std::string kernel;              // PassType::shader: "sap/subsurface_sap_up"
  std::string constants;           // CompiledPipeline::constants
  std::string program;             // the driver's name, if there are several programs; else ""
  std::vector<std::string> graphs; // that run the kernel
  // nullopt: the driver does not report the value
  std::array<std::optional<double>, kernel_value_count> values;
  std::vector<vulkan::PipelineStatistic> statistics; // all, as the driver reports them
  std::string assembly;
  std::string assembly_file; // name of the file with `assembly`; "": not written

  std::optional<double> value(KernelValue which) const {
    return values[static_cast<size_t>(which)];
  }
};

// Returns the rows of a pipeline; one row without values if the driver reports nothing.
std::vector<KernelRow> make_rows(std::string_view kernel,
                                 std::span<const vulkan::PipelineExecutable> executables);

} // namespace dermis::tools
