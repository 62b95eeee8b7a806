#pragma once
// Captures a frame as data: a list replaces the command buffer, and functions that append to it
// replace Vulkan's commands. The list holds exactly what would have been recorded.

#include "framegraph/vulkan/executor.hpp"
#include "integration/abi/commands/arena.hpp"
#include "integration/include/dermis/dermis.h"

namespace dermis::abi {

struct Capture {
  std::vector<dermis_command> commands;
  Arena arena;         // holds everything that the commands point to
  bool failed = false; // out of host memory: the list is incomplete
  // State of the next dispatch and the current pass.
  VkPipeline pipeline = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  const VkDescriptorSet* sets = nullptr;
  uint32_t set_count = 0;
  const void* push_constants = nullptr;
  uint32_t push_bytes = 0;
  const char* pass = "";
};

// Clears the list and keeps its memory.
void clear(Capture& capture) noexcept;
// Redirects a frame into the list.
void capture_into(Capture& capture, vulkan::FrameInput& frame) noexcept;
VkCommandBuffer handle_of(Capture& capture) noexcept; // represents the capture; not a Vulkan handle

} // namespace dermis::abi
