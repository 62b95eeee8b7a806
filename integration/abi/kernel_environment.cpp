#include "integration/abi/kernel_environment.hpp"

namespace dermis::abi {
namespace {

template <class T> vulkan::EnvironmentBinding table_binding(const std::vector<T>& table) {
  const auto bytes = std::as_bytes(std::span<const T>(table));
  return {vulkan::EnvironmentType::storage_buffer, bytes.size(), bytes};
}

} // namespace

KernelEnvironment kernel_environment(const subsurface::KernelTables& tables) {
  return {{
      {vulkan::EnvironmentType::uniform_buffer, sizeof(subsurface::FrameConstants), {}},
      table_binding(tables.profiles),
      table_binding(tables.separable),
      {vulkan::EnvironmentType::linear_sampler, 0, {}},
      table_binding(tables.pyramid),
      table_binding(tables.radial),
      {vulkan::EnvironmentType::counters, sizeof(subsurface::FrameCounters), {}},
  }};
}

} // namespace dermis::abi
