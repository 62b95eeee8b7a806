// Implements commands of the null device: commands are counted and otherwise ignored.
#include "integration/tools/null_device/state.hpp"

#include <iterator>

namespace dermis {
namespace {

template <class... Arguments>
VKAPI_ATTR void VKAPI_CALL count(VkCommandBuffer commands, Arguments...) {
  ++state_of(commands).commands;
}

VKAPI_ATTR void VKAPI_CALL count_barrier(VkCommandBuffer commands, const VkDependencyInfo*) {
  NullDeviceState& state = state_of(commands);
  ++state.commands;
  ++state.barriers;
}

template <class... Arguments>
VKAPI_ATTR void VKAPI_CALL count_dispatch(VkCommandBuffer commands, Arguments...) {
  NullDeviceState& state = state_of(commands);
  ++state.commands;
  ++state.dispatches;
}

VKAPI_ATTR void VKAPI_CALL count_buffer_copy(VkCommandBuffer commands, VkBuffer, VkBuffer, uint32_t,
                                             const VkBufferCopy*) {
  NullDeviceState& state = state_of(commands);
  ++state.commands;
  ++state.buffer_copies;
}

template <class Function> NullEntry command(const char* name) {
  const Function function = &count; // deduces the arguments from Function
  return entry(name, function);
}

} // namespace

PFN_vkVoidFunction command_function(const char* name) {
  static const NullEntry entries[] = {
      entry("vkCmdPipelineBarrier2", &count_barrier),
      command<PFN_vkCmdBindPipeline>("vkCmdBindPipeline"),
      command<PFN_vkCmdBindDescriptorSets>("vkCmdBindDescriptorSets"),
      command<PFN_vkCmdPushConstants>("vkCmdPushConstants"),
      entry<PFN_vkCmdDispatch>("vkCmdDispatch", &count_dispatch),
      entry<PFN_vkCmdDispatchIndirect>("vkCmdDispatchIndirect", &count_dispatch),
      command<PFN_vkCmdFillBuffer>("vkCmdFillBuffer"),
      entry("vkCmdCopyBuffer", &count_buffer_copy),
      command<PFN_vkCmdCopyImage>("vkCmdCopyImage"),
      command<PFN_vkCmdClearColorImage>("vkCmdClearColorImage"),
      command<PFN_vkCmdResetQueryPool>("vkCmdResetQueryPool"),
      command<PFN_vkCmdWriteTimestamp2>("vkCmdWriteTimestamp2"),
      command<PFN_vkCmdBeginDebugUtilsLabelEXT>("vkCmdBeginDebugUtilsLabelEXT"),
      command<PFN_vkCmdEndDebugUtilsLabelEXT>("vkCmdEndDebugUtilsLabelEXT"),
  };
  return find_entry(entries, std::size(entries), name);
}

} // namespace dermis
