#pragma once
// A frame as data: in place of a command buffer stands a list, and in place of Vulkan's commands functions
// that add to it. So it is what would have been recorded, command by command.

#include "framegraph/vulkan/executor.hpp"
#include "integration/abi/commands/arena.hpp"
#include "integration/include/dermis/dermis.h"

namespace dermis::abi {

struct Capture {
  std::vector<dermis_command> commands;
  Arena arena;         // of all that they point to
  bool failed = false; // out of host memory: the list is not whole
  // What the next dispatch will run with, and where it stands.
  VkPipeline pipeline = VK_NULL_HANDLE;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  const VkDescriptorSet* sets = nullptr;
  uint32_t set_count = 0;
  const void* push_constants = nullptr;
  uint32_t push_bytes = 0;
  const char* pass = "";
};

// Begins an empty list. Its memory stays.
void clear(Capture& capture) noexcept;
// Makes a frame go into the list.
void capture_into(Capture& capture, vulkan::FrameInput& frame) noexcept;
VkCommandBuffer handle_of(Capture& capture) noexcept; // stands for it; no Vulkan handle

} // namespace dermis::abi
