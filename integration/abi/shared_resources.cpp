#include "integration/abi/shared_resources.hpp"

#include <limits>

namespace dermis::abi {
namespace {

bool same(const vulkan::HostState& a, const vulkan::HostState& b) {
  return a.layout == b.layout && a.queue_family == b.queue_family && a.stages == b.stages &&
         a.access == b.access;
}

bool moves(const vulkan::HostState& state) {
  return state.queue_family != VK_QUEUE_FAMILY_IGNORED;
}

// Returns whether both slots only read, with equal states and no ownership transfer. Resources
// without a layout may then be shared.
template <class Host> bool only_read(const Slot& a, const Host& x, const Slot& b, const Host& y) {
  return !a.written && !b.written && same(x.before, y.before) && same(x.after, y.after) &&
         !moves(x.before) && !moves(x.after);
}

uint64_t end_of_layers(const vulkan::HostImage& image) {
  return image.layers == 0 ? std::numeric_limits<uint64_t>::max()
                           : uint64_t{image.first_layer} + image.layers;
}

// Slots with depth formats use the depth aspect, all others the colour aspect.
bool overlap(const Slot& a, const vulkan::HostImage& x, const Slot& b, const vulkan::HostImage& y) {
  return x.image == y.image && format_info(a.format).depth == format_info(b.format).depth &&
         x.first_layer < end_of_layers(y) && y.first_layer < end_of_layers(x);
}

bool may_share(const Slot& a, const vulkan::HostImage& x, const Slot& b,
               const vulkan::HostImage& y) {
  const auto rests = [&](const Slot& slot) {
    if (slot.first_layout == Layout::undefined) return x.before.layout == x.after.layout; // unused
    const auto used = static_cast<VkImageLayout>(slot.first_layout);
    return x.before.layout == used && x.after.layout == used;
  };
  return only_read(a, x, b, y) && rests(a) && rests(b);
}

bool overlap(const vulkan::HostBuffer& x, const vulkan::HostBuffer& y) {
  return x.buffer == y.buffer && x.offset < y.offset + y.bytes && y.offset < x.offset + x.bytes;
}

dermis_result check_pair(const dermis_view_t& view, const CompiledGraph& compiled_graph, size_t i,
                         size_t j) {
  const Slot &a = compiled_graph.slots[i], &b = compiled_graph.slots[j];
  const auto reject = [&](const char* what, const char* rule) {
    return bad_argument(view.context->log, "{}: slots '{}' and '{}' are bound to the same {}; {}",
                        view.function, a.name, b.name, what, rule);
  };
  const vulkan::HostImage &image = compiled_graph.images[i],
                          &other_image = compiled_graph.images[j];
  if (image.image != VK_NULL_HANDLE && overlap(a, image, b, other_image) &&
      !may_share(a, image, b, other_image))
    return reject(
        "aspect and layers of an image",
        "two slots share them only if the graph writes neither, their states are equal without a "
        "queue family transfer, and both layouts are dermis_slot.best_layout, or equal to each "
        "other if that is UNDEFINED");
  const vulkan::HostBuffer &buffer = compiled_graph.buffers[i],
                           &other_buffer = compiled_graph.buffers[j];
  if (buffer.buffer != VK_NULL_HANDLE && overlap(buffer, other_buffer) &&
      !only_read(a, buffer, b, other_buffer))
    return reject("bytes of a buffer",
                  "two slots share them only if the graph writes neither and their "
                  "states are equal without a queue family transfer");
  const vulkan::HostStructure &structure = compiled_graph.structures[i],
                              &other = compiled_graph.structures[j];
  if (structure.structure != VK_NULL_HANDLE && structure.structure == other.structure &&
      !only_read(a, structure, b, other))
    return reject("acceleration structure", "two slots share it only if their states are equal");
  return DERMIS_OK;
}

} // namespace

dermis_result check_shared_resources(const dermis_view_t& view,
                                     const CompiledGraph& compiled_graph) {
  for (size_t i = 0; i < compiled_graph.slots.size(); ++i)
    for (size_t j = i + 1; j < compiled_graph.slots.size(); ++j)
      if (const dermis_result result = check_pair(view, compiled_graph, i, j); result != DERMIS_OK)
        return result;
  return DERMIS_OK;
}

} // namespace dermis::abi
