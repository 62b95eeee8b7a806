// Allocates the plan's heaps as device memory, and creates the images and buffers placed in them.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace dermis::vulkan {
namespace {

Error create_heaps(State& state) {
  if (state.heap_pool != nullptr && !state.heap_pool->has(state.plan))
    return {ErrorKind::argument, VK_SUCCESS, "the heap pool was not created for this plan"};
  state.heaps.assign(state.plan.heaps.size(), {});
  for (uint32_t h = 0; h < state.heaps.size(); ++h) {
    const Heap& heap = state.plan.heaps[h];
    HeapMemory& memory = state.heaps[h];
    if (const auto shared = state.heap_pool ? state.heap_pool->find(state.plan, h) : std::nullopt) {
      memory.block = *shared;
      continue;
    }
    memory.owned = true;
    memory.request = {heap.persistent ? MemoryPurpose::history : MemoryPurpose::transient,
                      heap.memory_type_bits,
                      heap.size,
                      heap_alignment(*state.device, state.plan, h),
                      0,
                      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
    const std::string object =
        fmt::format("{} heap {}", heap.persistent ? "history" : "transient", h);
    if (Error error = allocate_memory(*state.device, memory.request, object, memory.block))
      return error;
  }
  return {};
}

// Checks that the driver's answers have not changed since the plan placed the resource.
Error check_needs(const State& state, const Placement& placement, const VkMemoryRequirements& needs,
                  const std::string& name) {
  const Heap& heap = state.plan.heaps[placement.heap];
  const bool fits = needs.size <= placement.size && placement.offset % needs.alignment == 0 &&
                    placement.offset + placement.size <= heap.size &&
                    (heap.memory_type_bits & ~needs.memoryTypeBits) == 0;
  if (fits) return {};
  return {ErrorKind::argument, VK_SUCCESS,
          fmt::format(
              "'{}' needs {} bytes aligned to {} of memory types {:#x}; the plan provides {} bytes "
              "at {} of types "
              "{:#x}: compile it with the profile of this device",
              name, needs.size, needs.alignment, needs.memoryTypeBits, placement.size,
              placement.offset, heap.memory_type_bits)};
}

Error create_view(const Device& device, const PlanResource& resource, VkImage image,
                  const SubresourceRange& range, const std::string& name, VkImageView& view) {
  VkImageViewCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  info.image = image;
  info.viewType = range.layers > 1 ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
  info.format = vk_format(resource.format);
  const VkImageAspectFlags aspect =
      format_info(resource.format).depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  info.subresourceRange = {aspect, range.first_mip, range.mips, range.first_layer, range.layers};
  const VkResult result =
      device.vk.vkCreateImageView(device.device, &info, device.allocator, &view);
  if (result != VK_SUCCESS) view = VK_NULL_HANDLE;
  return call_error(result, "vkCreateImageView", name);
}

Error create_image(State& state, const PlanResource& resource, const Placement& placement,
                   const std::string& name, Instance& instance) {
  const Device& device = *state.device;
  const VkImageCreateInfo info =
      image_create_info({resource.format, resource.width, resource.height, resource.mips,
                         resource.layers, resource.vk_usage});
  VkResult result =
      device.vk.vkCreateImage(device.device, &info, device.allocator, &instance.image);
  if (result != VK_SUCCESS) {
    instance.image = VK_NULL_HANDLE;
    return call_error(result, "vkCreateImage", name);
  }
  name_object(device, VK_OBJECT_TYPE_IMAGE, reinterpret_cast<uint64_t>(instance.image),
              name.c_str());
  VkMemoryRequirements needs{};
  device.vk.vkGetImageMemoryRequirements(device.device, instance.image, &needs);
  if (Error error = check_needs(state, placement, needs, name)) return error;
  const HeapMemory& heap = state.heaps[placement.heap];
  const VkBindImageMemoryInfo bind{VK_STRUCTURE_TYPE_BIND_IMAGE_MEMORY_INFO, nullptr,
                                   instance.image, heap.block.memory,
                                   heap.block.offset + placement.offset};
  result = device.vk.vkBindImageMemory2(device.device, 1, &bind);
  if (result != VK_SUCCESS) return call_error(result, "vkBindImageMemory2", name);
  if ((resource.vk_usage & viewable_usage) == 0) return {}; // only cleared
  SubresourceRange range = resource.whole();
  if (Error error = create_view(device, resource, instance.image, range, name, instance.all_mips))
    return error;
  range.mips = 1;
  return create_view(device, resource, instance.image, range, name, instance.first_mip);
}

// Creates views for accesses to some mips or layers of an image. Accesses with equal ranges share
// their views.
Error create_subresource_views(State& state, const Graph& graph) {
  constexpr Access viewed =
      access::shader_sampled_read | access::shader_storage_read | access::shader_storage_write;
  state.view_of_access.assign(state.plan.accesses.size(), no_index);
  for (size_t a = 0; a < state.plan.accesses.size(); ++a) {
    const PlanAccess& access = state.plan.accesses[a];
    const PlanResource& resource = state.plan.resources[access.resource];
    if (resource.first_instance == no_instance || access.range == resource.whole() ||
        (access.access & viewed) == 0)
      continue;
    for (size_t v = 0; v < state.subresource_views.size(); ++v)
      if (state.subresource_views[v].instance == resource.first_instance &&
          state.subresource_views[v].range == access.range)
        state.view_of_access[a] = static_cast<uint32_t>(v);
    if (state.view_of_access[a] != no_index) continue;
    state.view_of_access[a] = static_cast<uint32_t>(state.subresource_views.size());
    for (uint32_t i = 0; i < resource.instance_count; ++i) {
      SubresourceView& subresource_view = state.subresource_views.emplace_back();
      subresource_view.instance = resource.first_instance + i;
      subresource_view.range = access.range;
      if (Error error =
              create_view(*state.device, resource, state.instances[subresource_view.instance].image,
                          subresource_view.range, graph.resources[resource.declared.value].name,
                          subresource_view.view))
        return error;
    }
  }
  return {};
}

Error create_buffer(State& state, const PlanResource& resource, const Placement& placement,
                    const std::string& name, Instance& instance) {
  const Device& device = *state.device;
  const VkBufferCreateInfo info = buffer_create_info({resource.bytes, resource.vk_usage});
  VkResult result =
      device.vk.vkCreateBuffer(device.device, &info, device.allocator, &instance.buffer);
  if (result != VK_SUCCESS) {
    instance.buffer = VK_NULL_HANDLE;
    return call_error(result, "vkCreateBuffer", name);
  }
  name_object(device, VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(instance.buffer),
              name.c_str());
  VkMemoryRequirements needs{};
  device.vk.vkGetBufferMemoryRequirements(device.device, instance.buffer, &needs);
  if (Error error = check_needs(state, placement, needs, name)) return error;
  const HeapMemory& heap = state.heaps[placement.heap];
  const VkBindBufferMemoryInfo bind{VK_STRUCTURE_TYPE_BIND_BUFFER_MEMORY_INFO, nullptr,
                                    instance.buffer, heap.block.memory,
                                    heap.block.offset + placement.offset};
  result = device.vk.vkBindBufferMemory2(device.device, 1, &bind);
  return call_error(result, "vkBindBufferMemory2", name);
}

// Marks instances that share bytes with another instance.
void mark_aliased_instances(State& state) {
  const std::vector<Placement>& placements = state.plan.placements;
  std::vector<uint32_t> order(placements.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return std::tie(placements[a].heap, placements[a].offset) <
           std::tie(placements[b].heap, placements[b].offset);
  });
  const auto end = [&](uint32_t index) {
    return placements[index].offset + placements[index].size;
  };
  // index in `order` of the instance with the highest end in this heap so far
  uint32_t furthest = 0;
  for (uint32_t at = 1; at < order.size(); ++at) {
    const uint32_t before = order[furthest], here = order[at];
    const bool same_heap = placements[before].heap == placements[here].heap;
    if (same_heap && placements[here].offset < end(before))
      state.instances[before].aliased = state.instances[here].aliased = true;
    if (!same_heap || end(here) > end(before)) furthest = at;
  }
}

} // namespace

Error create_memory(State& state, const Graph& graph) {
  if (Error error = create_heaps(state)) return error;
  state.instances.assign(state.plan.placements.size(), {});
  mark_aliased_instances(state);
  for (const PlanResource& resource : state.plan.resources) {
    if (resource.first_instance == no_instance) continue;
    const std::string& name = graph.resources[resource.declared.value].name;
    for (uint32_t i = 0; i < resource.instance_count; ++i) {
      const uint32_t index = resource.first_instance + i;
      const std::string full_name =
          resource.instance_count > 1 ? fmt::format("{}#{}", name, i) : name;
      const Placement& placement = state.plan.placements[index];
      Error error =
          resource.type == ResourceType::image
              ? create_image(state, resource, placement, full_name, state.instances[index])
              : create_buffer(state, resource, placement, full_name, state.instances[index]);
      if (error) return error;
    }
  }
  return create_subresource_views(state, graph);
}

void destroy_memory(State& state) {
  const Device& device = *state.device;
  for (const SubresourceView& subresource_view : state.subresource_views)
    device.vk.vkDestroyImageView(device.device, subresource_view.view, device.allocator);
  for (const Instance& instance : state.instances) {
    device.vk.vkDestroyImageView(device.device, instance.all_mips, device.allocator);
    device.vk.vkDestroyImageView(device.device, instance.first_mip, device.allocator);
    device.vk.vkDestroyImage(device.device, instance.image, device.allocator);
    device.vk.vkDestroyBuffer(device.device, instance.buffer, device.allocator);
  }
  for (const HeapMemory& heap : state.heaps)
    if (heap.owned) free_memory(device, heap.block);
}

} // namespace dermis::vulkan
