#pragma once
// Describes descriptor set 1 of all kernels for executors: frame constants, tables, counters.

#include "framegraph/vulkan/executor.hpp"
#include "passes/common/kernel_tables.hpp"

#include <array>

namespace dermis::abi {

using KernelEnvironment =
    std::array<vulkan::EnvironmentBinding, static_cast<size_t>(subsurface::EnvironmentSlot::count)>;

// Returns the bindings in the order of EnvironmentSlot. They refer to `tables`, which must outlive
// them. Free-threaded.
KernelEnvironment kernel_environment(const subsurface::KernelTables& tables);

} // namespace dermis::abi
