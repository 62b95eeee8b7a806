#pragma once
// Holds what one device shares between its graphs.

#include "framegraph/compile/shared_heaps.hpp"
#include "framegraph/model/pass_type.hpp"
#include "framegraph/vulkan/device.hpp"
#include "framegraph/vulkan/device_profile.hpp"
#include "framegraph/vulkan/kernel_store.hpp"
#include "integration/abi/failure.hpp"
#include "integration/abi/host_pass_types.hpp"
#include "integration/abi/memory/device_memory.hpp"

#include <atomic>
#include <mutex>
#include <vector>

struct dermis_context_t {
  dermis::abi::Log log;
  dermis::abi::DeviceAllocator device_allocator; // `device` refers to it
  dermis::vulkan::Device device;
  dermis::DeviceProfile profile; // refers to `device`
  dermis::PassTypeRegistry pass_types;
  dermis::abi::HostPasses host_passes; // its pass types are part of `pass_types`
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;
  dermis::vulkan::KernelStore kernels; // of all graphs; refers to `device`
  uint32_t queue_family_count = 0;     // of the physical device
  bool has_foreign_queues = false;     // the physical device has VK_EXT_queue_family_foreign
  uint32_t frames_in_flight = 2;
  dermis::HistoryMemory history_memory = dermis::HistoryMemory::shared;
  std::atomic<bool> lost = false; // if true, every call except destroy returns DEVICE_LOST
  std::mutex mutex;               // guards `graphs`
  std::vector<dermis_graph> graphs;
};

namespace dermis::abi {

inline constexpr uint32_t default_frames_in_flight = 2;

dermis_result result_of(vulkan::ErrorKind kind);
DiagnosticId diagnostic_of(vulkan::ErrorKind kind);

// Returns DEVICE_LOST if the device is known to be lost, else OK.
dermis_result check_alive(const dermis_context_t& context, const char* function);

} // namespace dermis::abi
