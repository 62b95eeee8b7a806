#include "integration/tools/command/kernels/rows.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr KernelValueInfo values[] = {
    {"vgprs", "VGPRs"},
    {"sgprs", "SGPRs"},
    {"spilled_vgprs", "spilled VGPRs"},
    {"spilled_sgprs", "spilled SGPRs"},
    {"scratch_bytes", "scratch"},
    {"shared_bytes", "shared"},
    {"occupancy", "occupancy"},
    {"subgroup_size", "subgroup"},
    {"code_bytes", "code"},
    {"instructions", "instructions"},
};
static_assert(std::size(values) == kernel_value_count);

struct DriverName {
  std::string_view name; // of a statistic
  KernelValue value;
};

// Names of statistics: RADV first, then other drivers.
constexpr DriverName driver_names[] = {
    {"VGPRs", KernelValue::vgprs},
    {"SGPRs", KernelValue::sgprs},
    {"Spilled VGPRs", KernelValue::spilled_vgprs},
    {"Spilled SGPRs", KernelValue::spilled_sgprs},
    {"Scratch size", KernelValue::scratch_bytes},
    {"LDS size", KernelValue::shared_bytes},
    {"Subgroups per SIMD", KernelValue::occupancy},
    {"Code size", KernelValue::code_bytes},
    {"Instructions", KernelValue::instructions},
    // Intel (ANV)
    {"Instruction Count", KernelValue::instructions},
    {"Scratch Memory Size", KernelValue::scratch_bytes},
    {"Workgroup Memory Size", KernelValue::shared_bytes},
    {"Spill Count", KernelValue::spilled_vgprs},
    // NVIDIA
    {"Register Count", KernelValue::vgprs},
    {"Binary Size", KernelValue::code_bytes},
    {"Local Memory Size", KernelValue::scratch_bytes},
    {"Shared Memory Size", KernelValue::shared_bytes},
};
// NVIDIA 580 sets bits above the 32 that hold the bytes of local memory.
constexpr double memory_modulus = 4294967296.0;

} // namespace

std::span<const KernelValueInfo> kernel_values() {
  return values;
}

std::optional<KernelValue> find_kernel_value(std::string_view key) {
  for (size_t i = 0; i < std::size(values); ++i)
    if (values[i].key == key) return static_cast<KernelValue>(i);
  return std::nullopt;
}

std::vector<KernelRow> make_rows(std::string_view kernel,
                                 std::span<const vulkan::PipelineExecutable> executables) {
  std::vector<KernelRow> rows;
  for (const vulkan::PipelineExecutable& executable : executables) {
    KernelRow& row = rows.emplace_back();
    row.kernel = kernel;
    if (executables.size() > 1) row.program = executable.name;
    row.statistics = executable.statistics;
    row.assembly = executable.assembly;
    if (executable.subgroup_size > 0)
      row.values[static_cast<size_t>(KernelValue::subgroup_size)] = executable.subgroup_size;
    for (const vulkan::PipelineStatistic& statistic : executable.statistics)
      for (const DriverName& known : driver_names)
        if (known.name == statistic.name)
          row.values[static_cast<size_t>(known.value)] =
              known.value == KernelValue::scratch_bytes ? std::fmod(statistic.value, memory_modulus)
                                                        : statistic.value;
  }
  if (rows.empty()) rows.emplace_back().kernel = kernel;
  return rows;
}

} // namespace dermis::tools
