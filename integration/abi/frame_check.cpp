#include "integration/abi/frame_check.hpp"

#include "framegraph/vulkan/create_infos.hpp"
#include "integration/abi/memory_bindings.hpp"
#include "integration/abi/shared_resources.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

namespace dermis::abi {
namespace {

constexpr uint32_t known_frame_flags =
    DERMIS_FRAME_RESET_HISTORY | DERMIS_FRAME_BOUNDS | DERMIS_FRAME_LEFT_HANDED;

dermis_result check_numbers(const dermis_view_t& view, const dermis_frame& frame) {
  const Log& log = view.context->log;
  const char* const function = view.function;
  const uint32_t in_flight = view.context->frames_in_flight;
  if (frame.command_buffer == VK_NULL_HANDLE)
    return bad_argument(log, "{}: command_buffer is NULL", function);
  if ((frame.flags & ~known_frame_flags) != 0)
    return bad_argument(log, "{}: flags is {:#x}, known bits are {:#x}", function, frame.flags,
                        known_frame_flags);
  if (frame.frame_index <= view.last_frame)
    return bad_argument(log,
                        "{}: frame_index is {}, expected more than that of the previous frame, {}",
                        function, frame.frame_index, view.last_frame);
  if (frame.completed_frame_index >= frame.frame_index)
    return bad_argument(log, "{}: completed_frame_index is {}, expected less than frame_index, {}",
                        function, frame.completed_frame_index, frame.frame_index);
  if (frame.frame_index - frame.completed_frame_index > in_flight)
    return bad_argument(log,
                        "{}: frame_index is {} and completed_frame_index {}: with {} frames in "
                        "flight frame {} must "
                        "be complete",
                        function, frame.frame_index, frame.completed_frame_index, in_flight,
                        frame.frame_index - in_flight);
  if (!std::isfinite(frame.delta_seconds) || frame.delta_seconds < 0)
    return bad_argument(log, "{}: delta_seconds is {}, expected 0 or more", function,
                        frame.delta_seconds);
  if (!std::isfinite(frame.metres_per_unit) || frame.metres_per_unit < 0)
    return bad_argument(log, "{}: metres_per_unit is {}, expected more than 0, or 0 for 1",
                        function, frame.metres_per_unit);
  if (!std::isfinite(frame.exposure) || frame.exposure < 0)
    return bad_argument(log, "{}: exposure is {}, expected more than 0, or 0 for 1", function,
                        frame.exposure);
  if (!std::isfinite(frame.jitter_x) || !std::isfinite(frame.jitter_y))
    return bad_argument(log, "{}: jitter is ({}, {}), expected finite pixels", function,
                        frame.jitter_x, frame.jitter_y);
  const int kind = static_cast<int>(frame.depth_kind);
  if (kind != DERMIS_DEPTH_DEVICE && kind != DERMIS_DEPTH_VIEW_UNITS)
    return bad_argument(log, "{}: depth_kind is {}, expected 0 or 1", function, kind);
  const auto finite = [](const float(&matrix)[16]) {
    return std::all_of(std::begin(matrix), std::end(matrix),
                       [](float x) { return std::isfinite(x); });
  };
  if (!finite(frame.view_from_world) || !finite(frame.previous_clip_from_view) ||
      !finite(frame.previous_view_from_world))
    return bad_argument(log, "{}: a matrix has an element that is not finite", function);
  return DERMIS_OK;
}

dermis_result check_rectangle(const Log& log, const char* function, const Plan& plan,
                              const dermis_frame& frame, vulkan::Rectangle& out) {
  if (frame.rect_width == 0) {
    if (frame.rect_x != 0 || frame.rect_y != 0 || frame.rect_height != 0)
      return bad_argument(
          log, "{}: rect_width is 0 (the allocated size) and the rest of the rectangle is not",
          function);
    out = {0, 0, plan.view_width, plan.view_height};
    return DERMIS_OK;
  }
  out = {frame.rect_x, frame.rect_y, frame.rect_width, frame.rect_height};
  const bool inside = out.height > 0 && uint64_t{out.x} + out.width <= plan.view_width &&
                      uint64_t{out.y} + out.height <= plan.view_height;
  if (inside) return DERMIS_OK;
  return bad_argument(
      log, "{}: the rectangle {}x{} at ({}, {}) is not inside the allocated size {}x{}", function,
      out.width, out.height, out.x, out.y, plan.view_width, plan.view_height);
}

// Clips `first` .. `first + size` to 0 .. `extent`, relative to `corner`.
std::pair<int32_t, int32_t> clip(uint32_t first, uint32_t size, uint32_t corner, uint32_t extent) {
  const int64_t low = std::clamp<int64_t>(int64_t{first} - corner, 0, extent);
  const int64_t high = std::clamp<int64_t>(int64_t{first} + size - corner, low, extent);
  return {static_cast<int32_t>(low), static_cast<int32_t>(high - low)};
}

// Returns the bounds of subsurface relative to the rectangle's corner.
dermis_result check_bounds(const Log& log, const char* function, const dermis_frame& frame,
                           const vulkan::Rectangle& rectangle, std::array<int32_t, 4>& out) {
  if ((frame.flags & DERMIS_FRAME_BOUNDS) == 0) {
    if (frame.bounds_x != 0 || frame.bounds_y != 0 || frame.bounds_width != 0 ||
        frame.bounds_height != 0)
      return bad_argument(log, "{}: bounds are given, and flags is without DERMIS_FRAME_BOUNDS",
                          function);
    out = {0, 0, static_cast<int32_t>(rectangle.width), static_cast<int32_t>(rectangle.height)};
    return DERMIS_OK;
  }
  const auto [x, width] = clip(frame.bounds_x, frame.bounds_width, rectangle.x, rectangle.width);
  const auto [y, height] = clip(frame.bounds_y, frame.bounds_height, rectangle.y, rectangle.height);
  out = {x, y, width, height};
  return DERMIS_OK;
}

std::string_view format_name(VkFormat format) {
  const auto known = format_from_vulkan(static_cast<uint32_t>(format));
  return known ? format_info(*known).name : "a format unknown to graphs";
}

dermis_result check_state(const dermis_view_t& view, uint32_t index, const Slot& slot,
                          const char* which, const dermis_image_state& state) {
  const Log& log = view.context->log;
  const char* const function = view.function;
  if (state.access != 0 && state.stages == 0)
    return bad_argument(log, "{}: bindings[{}].{} ('{}') has access {:#x} but no stages", function,
                        index, which, slot.name, state.access);
  if (state.layout == VK_IMAGE_LAYOUT_MAX_ENUM)
    return bad_argument(log, "{}: bindings[{}].{}.layout ('{}') is not a layout", function, index,
                        which, slot.name);
  FamilyText text;
  const std::string_view problem = family_problem(*view.context, ResourceType::image, state, text);
  if (!problem.empty())
    return bad_argument(log, "{}: bindings[{}].{} ('{}'): {}", function, index, which, slot.name,
                        problem);
  return DERMIS_OK;
}

// Vulkan allows no barrier to these layouts, and so no ownership transfer in them.
bool is_only_initial(VkImageLayout layout) {
  return layout == VK_IMAGE_LAYOUT_UNDEFINED || layout == VK_IMAGE_LAYOUT_PREINITIALIZED;
}

dermis_result check_binding(const dermis_view_t& view, uint32_t index, const Slot& slot,
                            const dermis_image_binding& binding) {
  const Log& log = view.context->log;
  const char* const function = view.function;
  if (binding.image == VK_NULL_HANDLE ||
      (binding.view == VK_NULL_HANDLE && binding.content_id == 0))
    return bad_argument(log, "{}: bindings[{}].{} ('{}') is null", function, index,
                        binding.image == VK_NULL_HANDLE ? "image" : "view", slot.name);
  if (static_cast<uint32_t>(binding.format) != format_info(slot.format).vulkan)
    return bad_argument(log,
                        "{}: bindings[{}].format ('{}') is {} (VkFormat {}), the graph was "
                        "compiled for {}; name the "
                        "format in dermis_graph_desc.formats",
                        function, index, slot.name, format_name(binding.format),
                        static_cast<uint32_t>(binding.format), format_info(slot.format).name);
  if (binding.width < slot.width || binding.height < slot.height)
    return bad_argument(log, "{}: bindings[{}] ('{}') is {}x{}, the graph needs at least {}x{}",
                        function, index, slot.name, binding.width, binding.height, slot.width,
                        slot.height);
  if (slot.read && binding.before.layout == VK_IMAGE_LAYOUT_UNDEFINED)
    return bad_argument(
        log,
        "{}: bindings[{}].before.layout ('{}') is UNDEFINED, which discards what the graph reads",
        function, index, slot.name);
  if (binding.before.transfer != 0 && is_only_initial(binding.before.layout) &&
      binding.before.queue_family != view.context->device.queue_family)
    return bad_argument(
        log,
        "{}: bindings[{}].before ('{}') transfers an image from another queue family in layout {}, "
        "in which Vulkan allows no transfer; set transfer to 0",
        function, index, slot.name,
        binding.before.layout == VK_IMAGE_LAYOUT_UNDEFINED ? "UNDEFINED" : "PREINITIALIZED");
  if (is_only_initial(binding.after.layout))
    return bad_argument(
        log, "{}: bindings[{}].after.layout ('{}') is {}, to which an image cannot be transitioned",
        function, index, slot.name,
        binding.after.layout == VK_IMAGE_LAYOUT_UNDEFINED ? "UNDEFINED" : "PREINITIALIZED");
  if (binding.layer > 0 && binding.layer_count == 0)
    return bad_argument(
        log, "{}: bindings[{}].layer ('{}') is {} and layer_count 0, which means all layers",
        function, index, slot.name, binding.layer);
  if (const dermis_result result = check_state(view, index, slot, "before", binding.before);
      result != DERMIS_OK)
    return result;
  return check_state(view, index, slot, "after", binding.after);
}

// Returns the image view of a binding: the host's, or one that the library keeps.
dermis_result find_view(dermis_view_t& view, uint32_t index, const Slot& slot,
                        const dermis_frame& frame, const dermis_image_binding& binding,
                        KnownView& found) {
  found = {binding.view, 0};
  if (binding.view != VK_NULL_HANDLE || (slot.vk_usage & vulkan::viewable_usage) == 0)
    return DERMIS_OK;
  const Log& log = view.context->log;
  const char* const function = view.function;
  const ImageViewKey key{binding.slot,
                         binding.image,
                         binding.content_id,
                         binding.format,
                         format_info(slot.format).depth
                             ? VkImageAspectFlags{VK_IMAGE_ASPECT_DEPTH_BIT}
                             : VkImageAspectFlags{VK_IMAGE_ASPECT_COLOR_BIT},
                         binding.layer};
  const VkResult result = find_image_view(view.image_views, key, frame.frame_index, view.last_frame,
                                          frame.completed_frame_index, found);
  if (result == VK_SUCCESS) return DERMIS_OK;
  if (result == VK_ERROR_TOO_MANY_OBJECTS)
    return bad_argument(log,
                        "{}: bindings[{}] ('{}') alternates between more than {} images within the "
                        "frames in flight; give views for them",
                        function, index, slot.name, image_views_a_slot);
  const vulkan::ErrorKind kind = vulkan::kind_of(result);
  if (kind == vulkan::ErrorKind::device_lost) view.context->lost = true;
  return fail(log, result_of(kind), diagnostic_of(kind),
              "{}: bindings[{}] ('{}'): vkCreateImageView failed ({})", function, index, slot.name,
              vulkan::result_name(result));
}

// Reports all slots without a binding in one message.
dermis_result check_complete(const Log& log, const char* function,
                             const CompiledGraph& compiled_graph) {
  constexpr size_t rest_of_message = 256; // reserves space for the advice after a long list
  std::array<char, failure_text_size - rest_of_message> names;
  size_t used = 0;
  bool optional = false;
  for (size_t i = 0; i < compiled_graph.slots.size(); ++i) {
    const bool given = compiled_graph.images[i].image != VK_NULL_HANDLE ||
                       compiled_graph.buffers[i].buffer != VK_NULL_HANDLE ||
                       compiled_graph.structures[i].structure != VK_NULL_HANDLE;
    const Slot& slot = compiled_graph.slots[i];
    if (!slot.in_plan || given) continue;
    optional = optional || !slot.required;
    const auto written = fmt::format_to_n(names.data() + used, names.size() - used,
                                          "{}'{}' (slot {}, {})", used == 0 ? "" : ", ", slot.name,
                                          i, slot.required ? "required" : "optional");
    used = std::min(names.size(), used + written.size);
  }
  if (used == 0) return DERMIS_OK;
  return bad_argument(log, "{}: nothing is bound to {}{}", function,
                      std::string_view{names.data(), used},
                      optional ? "; bind an optional slot in every frame, or name it in "
                                 "dermis_graph_desc.unbound when the graph is created or reloaded"
                               : "");
}

dermis_result check_bindings(dermis_view_t& view, CompiledGraph& compiled_graph,
                             const dermis_frame& frame) {
  const Log& log = view.context->log;
  const char* const function = view.function;
  if (frame.binding_count > 0 && frame.bindings == nullptr)
    return bad_argument(log, "{}: bindings is NULL and binding_count is {}", function,
                        frame.binding_count);
  std::fill(compiled_graph.images.begin(), compiled_graph.images.end(), vulkan::HostImage{});
  for (uint32_t i = 0; i < frame.binding_count; ++i) {
    dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
    if (const SizedRead read = read_element(frame.bindings, i, binding); read != SizedRead::ok)
      return rejected_element(log, read, function, "bindings", frame.bindings, i);
    if (binding.slot >= compiled_graph.slots.size())
      return bad_argument(log, "{}: bindings[{}].slot is {}, the graph has slots 0..{}", function,
                          i, binding.slot, static_cast<int64_t>(compiled_graph.slots.size()) - 1);
    const Slot& slot = compiled_graph.slots[binding.slot];
    if (slot.type != ResourceType::image)
      return bad_argument(log, "{}: bindings[{}] binds an image to slot {} ('{}'), which takes {}",
                          function, i, binding.slot, slot.name, type_phrase(slot.type));
    if (!slot.in_plan) continue;
    vulkan::HostImage& image = compiled_graph.images[binding.slot];
    if (image.image != VK_NULL_HANDLE)
      return bad_argument(log, "{}: bindings[{}] binds slot {} ('{}') a second time", function, i,
                          binding.slot, slot.name);
    if (const dermis_result result = check_binding(view, i, slot, binding); result != DERMIS_OK)
      return result;
    KnownView known;
    if (const dermis_result result = find_view(view, i, slot, frame, binding, known);
        result != DERMIS_OK)
      return result;
    image = {
        binding.image, known.view,          host_state(binding.before), host_state(binding.after),
        binding.layer, binding.layer_count, binding.content_id,         known.id};
  }
  if (const dermis_result result = check_memory_bindings(view, compiled_graph, frame);
      result != DERMIS_OK)
    return result;
  if (const dermis_result result = check_complete(log, function, compiled_graph);
      result != DERMIS_OK)
    return result;
  return check_shared_resources(view, compiled_graph);
}

// Removes the jitter: shifting the picture by `pixels` of `extent` shifts clip space by 2 * pixels
// / extent.
void remove_jitter(subsurface::Matrix4& clip_from_view, int row, double pixels, double extent) {
  for (size_t c = 0; c < 4; ++c)
    clip_from_view[row * 4 + c] -= 2.0 * pixels / extent * clip_from_view[12 + c];
}

subsurface::Matrix4 matrix_of(const float (&elements)[16]) {
  subsurface::Matrix4 matrix;
  std::copy(std::begin(elements), std::end(elements), matrix.begin());
  return matrix;
}

subsurface::CameraFault fill_constants(const dermis_frame& frame,
                                       const CompiledGraph& compiled_graph,
                                       const vulkan::Rectangle& previous,
                                       const vulkan::Rectangle& rectangle,
                                       const std::array<int32_t, 4>& bounds, bool history_invalid,
                                       subsurface::FrameConstants& constants) {
  subsurface::FrameInput input;
  input.bounds = bounds;
  input.rect_x = rectangle.x;
  input.rect_y = rectangle.y;
  input.rect_width = rectangle.width;
  input.rect_height = rectangle.height;
  input.camera = {matrix_of(frame.clip_from_view), matrix_of(frame.view_from_world),
                  matrix_of(frame.previous_clip_from_view),
                  matrix_of(frame.previous_view_from_world)};
  remove_jitter(input.camera.clip_from_view, 0, frame.jitter_x, rectangle.width);
  remove_jitter(input.camera.clip_from_view, 1, frame.jitter_y, rectangle.height);
  std::optional<subsurface::Handedness> declared;
  if ((frame.flags & DERMIS_FRAME_LEFT_HANDED) != 0) declared = subsurface::Handedness::left;
  const subsurface::CameraFault fault =
      subsurface::to_right_handed(input.camera, declared, input.handedness);
  if (fault != subsurface::CameraFault::none) return fault;
  const subsurface::Matrix4& clip = input.camera.clip_from_view;
  const double depth_changes = clip[14] != 0 ? clip[11] : clip[10]; // perspective, orthographic
  if (frame.depth_kind == DERMIS_DEPTH_DEVICE && depth_changes == 0)
    return subsurface::CameraFault::no_depth;
  input.jitter_px = {frame.jitter_x, frame.jitter_y};
  input.metres_per_unit = frame.metres_per_unit == 0 ? 1.0 : frame.metres_per_unit;
  input.exposure = frame.exposure == 0 ? 1.0f : frame.exposure;
  input.depth_kind = frame.depth_kind == DERMIS_DEPTH_VIEW_UNITS ? subsurface::DepthKind::view_units
                                                                 : subsurface::DepthKind::device;
  input.frame_index = frame.frame_index;
  input.history_invalid = history_invalid;
  input.previous_x = previous.x;
  input.previous_y = previous.y;
  input.previous_width = previous.width;
  input.previous_height = previous.height;
  input.previous_jitter_px = compiled_graph.last_jitter_px;
  return subsurface::fill_frame_constants(input, constants)
             ? subsurface::CameraFault::none
             : subsurface::CameraFault::no_projection;
}

// Returns advice on how to declare view space, if that may be the cause.
std::string_view hint_of(subsurface::CameraFault fault) {
  const bool of_handedness = fault != subsurface::CameraFault::no_projection &&
                             fault != subsurface::CameraFault::no_depth &&
                             fault != subsurface::CameraFault::stored_by_columns;
  return of_handedness ? "; the camera looks down -z, or along +z in an orthographic frame with "
                         "DERMIS_FRAME_LEFT_HANDED and in a perspective with w = z"
                       : "";
}

} // namespace

dermis_result check_frame(dermis_view_t& view, CompiledGraph& compiled_graph,
                          const dermis_frame& frame, CheckedFrame& checked) {
  const Log& log = view.context->log;
  const char* const function = view.function;
  if (const dermis_result result = check_numbers(view, frame); result != DERMIS_OK) return result;
  if (const dermis_result result =
          check_rectangle(log, function, compiled_graph.plans.front().compiled->plan, frame,
                          checked.input.rectangle);
      result != DERMIS_OK)
    return result;
  if (const dermis_result result =
          check_bounds(log, function, frame, checked.input.rectangle, checked.bounds);
      result != DERMIS_OK)
    return result;
  return check_bindings(view, compiled_graph, frame);
}

dermis_result fill_frame(const dermis_view_t& view, const CompiledGraph& compiled_graph,
                         const Chosen& chosen, const dermis_frame& frame, CheckedFrame& checked) {
  const Log& log = view.context->log;
  const char* const function = view.function;
  const RunnablePlan& plan = compiled_graph.plans[chosen.plan];
  const vulkan::Executor& executor = *plan.executor;
  const vulkan::Executor* const before = chosen.before;
  const bool reset = (frame.flags & DERMIS_FRAME_RESET_HISTORY) != 0;
  bool history_invalid = false;
  for (uint32_t i = 0; i < executor.history_count(); ++i)
    history_invalid = history_invalid || !executor.history_state(i, reset, before).valid;
  if (const subsurface::CameraFault fault = fill_constants(
          frame, compiled_graph, executor.previous_rectangle(before), checked.input.rectangle,
          checked.bounds, history_invalid, checked.constants);
      fault != subsurface::CameraFault::none)
    return bad_argument(log, "{}: {}{}", function, subsurface::text_of(fault), hint_of(fault));
  checked.constants.sample_units = chosen.sample_units;
  checked.constants.view_frame = (reset ? 0 : view.frames) + 1;
  if (chosen.probed) checked.constants.flags |= subsurface::always_probed;
  checked.input.command_buffer = frame.command_buffer;
  checked.input.images = compiled_graph.images;
  checked.input.buffers = compiled_graph.buffers;
  checked.input.structures = compiled_graph.structures;
  checked.input.frame_constants = std::as_bytes(std::span(&checked.constants, 1));
  checked.input.settings = compiled_graph.configurations[chosen.configuration].settings;
  checked.input.frame_index = frame.frame_index;
  checked.input.reset_history = reset;
  checked.input.memory_overwritten =
      before != nullptr && compiled_graph.last_frame > 0; // of the memory pool
  checked.input.before = before;
  checked.input.view_user = view.user;
  checked.history_invalid = history_invalid;
  checked.history_unread = executor.history_count() > 0 &&
                           (checked.constants.flags & subsurface::no_previous_frame) != 0;
  if (checked.empty_bounds()) checked.input.left_out = plan.left_out;
  return DERMIS_OK;
}

} // namespace dermis::abi
