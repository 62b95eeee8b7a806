#include "integration/abi/memory_bindings.hpp"

#include <algorithm>

namespace dermis::abi {
namespace {

struct BindingPlace { // identifies one binding in messages
  const Log& log;
  const char* function;
  const char* array;
  uint32_t index;
};

template <class... Arguments>
dermis_result reject(const BindingPlace& place, fmt::format_string<Arguments...> text,
                     Arguments&&... arguments) {
  std::array<char, failure_text_size> what;
  const auto end =
      fmt::format_to_n(what.data(), what.size(), text, std::forward<Arguments>(arguments)...);
  return bad_argument(place.log, "{}: {}[{}]{}", place.function, place.array, place.index,
                      std::string_view{what.data(), std::min(what.size(), end.size)});
}

dermis_result check_state(const dermis_view_t& view, const BindingPlace& place, const Slot& slot,
                          const char* which, const dermis_image_state& state) {
  if (state.access != 0 && state.stages == 0)
    return reject(place, ".{} ('{}') has access {:#x} but no stages", which, slot.name,
                  state.access);
  if (state.layout != VK_IMAGE_LAYOUT_UNDEFINED)
    return reject(place, ".{}.layout ('{}') is {}, expected UNDEFINED: only images have layouts",
                  which, slot.name, static_cast<uint32_t>(state.layout));
  FamilyText text;
  const std::string_view problem = family_problem(*view.context, slot.type, state, text);
  if (!problem.empty()) return reject(place, ".{} ('{}'): {}", which, slot.name, problem);
  return DERMIS_OK;
}

// Returns the slot that the host binds. Returns null after an error in `result`, or if the plan
// does not use the slot. `bound_before`: the host already bound it in this call.
const Slot* find_slot(const BindingPlace& place, const CompiledGraph& compiled_graph,
                      uint32_t number, ResourceType type, bool bound_before,
                      dermis_result& result) {
  result = DERMIS_OK;
  const Slot& slot = compiled_graph.slots[number];
  if (slot.type != type)
    result = reject(place, " binds {} to slot {} ('{}'), which takes {}", type_phrase(type), number,
                    slot.name, type_phrase(slot.type));
  else if (slot.in_plan && bound_before)
    result = reject(place, " binds slot {} ('{}') a second time", number, slot.name);
  return result == DERMIS_OK && slot.in_plan ? &slot : nullptr;
}

// Calls `use(place, binding)` for each element of a caller's array.
template <class T, class Use>
dermis_result for_each(const BindingPlace& array, const CompiledGraph& compiled_graph,
                       const T* items, uint32_t count, const T& defaults, Use use) {
  if (count == 0) return DERMIS_OK;
  if (items == nullptr)
    return bad_argument(array.log, "{}: {} is NULL and its count is {}", array.function,
                        array.array, count);
  for (uint32_t i = 0; i < count; ++i) {
    const BindingPlace place{array.log, array.function, array.array, i};
    T item = defaults;
    if (const SizedRead read = read_element(items, i, item); read != SizedRead::ok)
      return rejected_element(array.log, read, array.function, array.array, items, i);
    if (item.slot >= compiled_graph.slots.size())
      return reject(place, ".slot is {}, the graph has slots 0..{}", item.slot,
                    static_cast<int64_t>(compiled_graph.slots.size()) - 1);
    if (const dermis_result result = use(place, item); result != DERMIS_OK) return result;
  }
  return DERMIS_OK;
}

dermis_result check_buffer(const dermis_view_t& view, const BindingPlace& place, const Slot& slot,
                           const dermis_buffer_binding& binding) {
  const VkPhysicalDeviceLimits& limits = view.context->device.properties.limits;
  const uint64_t alignment = std::max<uint64_t>(limits.minStorageBufferOffsetAlignment, 1);
  if (binding.buffer == VK_NULL_HANDLE) return reject(place, ".buffer ('{}') is null", slot.name);
  if (binding.offset % alignment != 0)
    return reject(place, ".offset ('{}') is {}, expected a multiple of {}", slot.name,
                  binding.offset, alignment);
  if (binding.bytes < slot.bytes)
    return reject(place, ".bytes ('{}') is {}, the graph needs at least {}", slot.name,
                  binding.bytes, slot.bytes);
  if (binding.bytes % slot.stride != 0)
    return reject(place, ".bytes ('{}') is {}, no multiple of the {} bytes of an element",
                  slot.name, binding.bytes, slot.stride);
  if (binding.bytes > limits.maxStorageBufferRange)
    return reject(place, ".bytes ('{}') is {}, the device binds at most {}", slot.name,
                  binding.bytes, limits.maxStorageBufferRange);
  return DERMIS_OK;
}

dermis_result check_states(const dermis_view_t& view, const BindingPlace& place, const Slot& slot,
                           const dermis_image_state& before, const dermis_image_state& after) {
  if (const dermis_result result = check_state(view, place, slot, "before", before);
      result != DERMIS_OK)
    return result;
  return check_state(view, place, slot, "after", after);
}

// Returns "3", or the name of a special value.
fmt::string_view family_name(uint32_t family, std::array<char, 16>& number) {
  switch (family) {
  case VK_QUEUE_FAMILY_IGNORED:
    return "VK_QUEUE_FAMILY_IGNORED";
  case VK_QUEUE_FAMILY_EXTERNAL:
    return "VK_QUEUE_FAMILY_EXTERNAL";
  case VK_QUEUE_FAMILY_FOREIGN_EXT:
    return "VK_QUEUE_FAMILY_FOREIGN_EXT";
  default:
    return {number.data(), fmt::format_to_n(number.data(), number.size(), "{}", family).size};
  }
}

} // namespace

std::string_view family_problem(const dermis_context_t& context, ResourceType type,
                                const dermis_image_state& state, FamilyText& text) {
  std::array<char, 16> number;
  const fmt::string_view family = family_name(state.queue_family, number);
  const auto say = [&](auto format, const auto&... arguments) {
    const auto end = fmt::format_to_n(text.data(), text.size(), format, arguments...);
    return std::string_view{text.data(), std::min(end.size, text.size())};
  };
  if (state.transfer > 1) return say(FMT_STRING("transfer is {}, expected 0 or 1"), state.transfer);
  const bool own = state.queue_family == context.device.queue_family;
  if (state.transfer == 0) {
    if (state.queue_family == 0 || own || state.queue_family == VK_QUEUE_FAMILY_IGNORED) return {};
    return say(
        FMT_STRING(
            "queue_family is {} and transfer 0; set transfer to 1 for an ownership transfer, "
            "or queue_family to 0 for none"),
        family);
  }
  if (type == ResourceType::acceleration_structure)
    return "transfer is 1, expected 0: an acceleration structure has no ownership transfer; "
           "transfer the buffer that holds it";
  switch (state.queue_family) {
  case VK_QUEUE_FAMILY_EXTERNAL:
    return {};
  case VK_QUEUE_FAMILY_FOREIGN_EXT:
    if (context.has_foreign_queues) return {};
    return say(FMT_STRING("queue_family is {}, which needs {}; the device lacks it"), family,
               VK_EXT_QUEUE_FAMILY_FOREIGN_EXTENSION_NAME);
  case VK_QUEUE_FAMILY_IGNORED:
    return say(
        FMT_STRING(
            "queue_family is {} and transfer 1; set transfer to 0 for no ownership transfer"),
        family);
  default:
    if (state.queue_family < context.queue_family_count) return {};
    return say(FMT_STRING("queue_family is {}, the device has {} families"), family,
               context.queue_family_count);
  }
}

dermis_result check_memory_bindings(dermis_view_t& view, CompiledGraph& compiled_graph,
                                    const dermis_frame& frame) {
  const Log& log = view.context->log;
  const char* const function = view.function;
  std::fill(compiled_graph.buffers.begin(), compiled_graph.buffers.end(), vulkan::HostBuffer{});
  std::fill(compiled_graph.structures.begin(), compiled_graph.structures.end(),
            vulkan::HostStructure{});
  const dermis_buffer_binding no_buffer = DERMIS_BUFFER_BINDING_INIT;
  const auto bind_buffer = [&](const BindingPlace& place, const dermis_buffer_binding& binding) {
    vulkan::HostBuffer& bound = compiled_graph.buffers[binding.slot];
    dermis_result result = DERMIS_OK;
    const Slot* slot = find_slot(place, compiled_graph, binding.slot, ResourceType::buffer,
                                 bound.buffer != VK_NULL_HANDLE, result);
    if (slot == nullptr) return result;
    result = check_buffer(view, place, *slot, binding);
    if (result == DERMIS_OK)
      result = check_states(view, place, *slot, binding.before, binding.after);
    bound = {binding.buffer, binding.offset, binding.bytes, host_state(binding.before),
             host_state(binding.after)};
    return result;
  };
  const dermis_result result = for_each({log, function, "buffers", 0}, compiled_graph,
                                        frame.buffers, frame.buffer_count, no_buffer, bind_buffer);
  if (result != DERMIS_OK) return result;
  const dermis_acceleration_structure_binding no_structure =
      DERMIS_ACCELERATION_STRUCTURE_BINDING_INIT;
  const auto bind_structure = [&](const BindingPlace& place,
                                  const dermis_acceleration_structure_binding& binding) {
    vulkan::HostStructure& bound = compiled_graph.structures[binding.slot];
    dermis_result checked = DERMIS_OK;
    const Slot* slot =
        find_slot(place, compiled_graph, binding.slot, ResourceType::acceleration_structure,
                  bound.structure != VK_NULL_HANDLE, checked);
    if (slot == nullptr) return checked;
    if (binding.structure == VK_NULL_HANDLE)
      return reject(place, ".structure ('{}') is null", slot->name);
    bound = {binding.structure, host_state(binding.before), host_state(binding.after)};
    return check_states(view, place, *slot, binding.before, binding.after);
  };
  return for_each({log, function, "structures", 0}, compiled_graph, frame.structures,
                  frame.structure_count, no_structure, bind_structure);
}

} // namespace dermis::abi
