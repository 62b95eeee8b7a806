#include "integration/tools/command/run/device_graph.hpp"
#include "framegraph/model/pixel_grid.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

// Returns the state of an image between frames, valid for the graph, an upload and a readback.
demo::ImageState resting_state(VkImageLayout layout) {
  return {layout == VK_IMAGE_LAYOUT_UNDEFINED ? VK_IMAGE_LAYOUT_GENERAL : layout,
          VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
          VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT};
}

demo::Result<> set_settings(dermis_graph graph, const DeviceGraphRequest& request) {
  for (const auto& [name, json] : request.settings) {
    demo::Report report;
    const dermis_result result =
        dermis_graph_set_setting(graph, name.c_str(), json.c_str(), &report.handle);
    if (result != DERMIS_OK)
      return demo::dermis_error("dermis_graph_set_setting", result, report.handle);
  }
  return demo::success();
}

dermis_image_state c_state(const demo::ImageState& state) {
  return {state.layout, 0, state.stages, state.access, 0};
}

} // namespace

bool same_but_size(const DeviceGraphRequest& a, const DeviceGraphRequest& b) {
  return a.graph_name == b.graph_name && a.graph_text == b.graph_text && a.overlays == b.overlays &&
         a.formats == b.formats && a.unbound == b.unbound && a.profiles == b.profiles &&
         a.settings == b.settings && pixel_grid(a.pixel_aspect) == pixel_grid(b.pixel_aspect);
}

demo::Result<std::unique_ptr<DeviceGraph>> DeviceGraph::create(demo::VulkanHost& host,
                                                               const DeviceGraphRequest& request) {
  std::unique_ptr<DeviceGraph> made(new DeviceGraph(host));
  if (auto ready = demo::make_context(host, 1, false, host.tool_context, request.hooks); !ready)
    return ready.error();
  made->context_ = host.tool_context;
  made->recorded_ = request.hooks.recorded;
  demo::Report report;
  const auto graph = demo::create_graph(host.tool_context.get(), request, report);
  if (!graph) return graph.error();
  made->graph_ = *graph;
  if (auto set = set_settings(*graph, request); !set) return set.error();
  if (auto images = made->create_images(); !images) return images.error();
  return made;
}

DeviceGraph::~DeviceGraph() {
  dermis_graph_destroy(graph_);
}

demo::Result<> DeviceGraph::create_images() {
  uint32_t count = 0;
  dermis_result result = dermis_graph_slots(graph_, &count, nullptr);
  std::vector<dermis_slot> slots(count, dermis_slot DERMIS_SLOT_INIT);
  if (result == DERMIS_OK && count > 0) result = dermis_graph_slots(graph_, &count, slots.data());
  if (result != DERMIS_OK) return demo::dermis_error("dermis_graph_slots", result);
  for (const dermis_slot& slot : slots) {
    if (slot.bound == 0) continue;
    demo::ImageDesc desc;
    desc.format = slot.format;
    desc.width = slot.width;
    desc.height = slot.height;
    // Also sampled: an image that the plan leaves unused still needs a view.
    desc.usage = slot.usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                 VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    auto image = demo::create_image(host_, desc);
    if (!image) return image.error();
    slots_.push_back({slot, slot.name, image.take(), {}});
  }
  return demo::success();
}

demo::Result<> DeviceGraph::resize(uint32_t width, uint32_t height) {
  demo::Report report;
  const dermis_result result = dermis_graph_resize(graph_, width, height, &report.handle);
  if (result != DERMIS_OK) return demo::dermis_error("dermis_graph_resize", result, report.handle);
  slots_.clear(); // safe because each frame is waited for
  return create_images();
}

demo::Result<> DeviceGraph::set_budget(const dermis_budget& budget) {
  demo::Report report;
  const dermis_result result = dermis_graph_set_budget(graph_, &budget, &report.handle);
  if (result != DERMIS_OK)
    return demo::dermis_error("dermis_graph_set_budget", result, report.handle);
  return demo::success();
}

DeviceGraph::Slot* DeviceGraph::find(std::string_view name) {
  for (Slot& slot : slots_)
    if (slot.name == name) return &slot;
  return nullptr;
}

bool DeviceGraph::has(std::string_view slot) const {
  for (const Slot& one : slots_)
    if (one.name == slot) return true;
  return false;
}

demo::Result<> DeviceGraph::upload(std::string_view slot, std::span<const float> texels,
                                   uint32_t channels) {
  Slot* target = find(slot);
  if (target == nullptr) return demo::success();
  target->state = resting_state(target->slot.best_layout);
  return demo::upload_image(host_, target->image, texels, channels, target->state);
}

demo::Result<std::vector<float>> DeviceGraph::read_rgb(std::string_view slot) {
  Slot* source = find(slot);
  const demo::PixelFormat* format =
      source != nullptr ? demo::find_pixel_format(source->image.format) : nullptr;
  if (format == nullptr || format->channels < 3)
    return demo::Error{demo::ErrorKind::input,
                       fmt::format("slot '{}' holds no picture of three channels", slot)};
  auto texels = demo::read_image(host_, source->image, source->state);
  if (!texels) return texels.error();
  std::vector<float> rgb;
  rgb.reserve(texels->size() / format->channels * 3);
  for (size_t i = 0; i + 2 < texels->size(); i += format->channels)
    rgb.insert(rgb.end(), texels->begin() + static_cast<std::ptrdiff_t>(i),
               texels->begin() + static_cast<std::ptrdiff_t>(i) + 3);
  return rgb;
}

demo::Result<> DeviceGraph::run(dermis_frame frame) {
  std::vector<dermis_image_binding> bindings;
  for (Slot& slot : slots_) {
    dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
    binding.slot = slot.slot.id;
    binding.format = slot.image.format;
    binding.image = slot.image.image;
    binding.view = slot.image.view;
    binding.width = slot.image.width;
    binding.height = slot.image.height;
    binding.before = c_state(slot.state);
    slot.state = resting_state(slot.slot.best_layout);
    binding.after = c_state(slot.state);
    binding.content_id = slot.image.id;
    bindings.push_back(binding);
  }
  frame.bindings = bindings.data();
  frame.binding_count = static_cast<uint32_t>(bindings.size());
  frame.completed_frame_index = frame_index_; // each frame is waited for
  frame.frame_index = ++frame_index_;
  return demo::run_commands(host_, [&](VkCommandBuffer commands) -> demo::Result<> {
    frame.command_buffer = commands;
    const dermis_result result = dermis_view_record(dermis_graph_view(graph_), &frame);
    if (result != DERMIS_OK) return demo::dermis_error("dermis_view_record", result);
    return recorded_ ? recorded_() : demo::success();
  });
}

std::vector<DeviceGraph::PassTime> DeviceGraph::times() {
  uint32_t count = 0;
  if (dermis_view_timings(dermis_graph_view(graph_), frame_index_, &count, nullptr) != DERMIS_OK ||
      count == 0)
    return {};
  std::vector<dermis_pass_timing> timings(count, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
  if (dermis_view_timings(dermis_graph_view(graph_), frame_index_, &count, timings.data()) !=
      DERMIS_OK)
    return {};
  std::vector<PassTime> times;
  for (const dermis_pass_timing& timing : timings)
    times.push_back({timing.pass, static_cast<double>(timing.nanoseconds) * 1e-6});
  return times;
}

std::optional<demo::ReportedFrame> DeviceGraph::choice() {
  demo::ReportedFrame choice;
  if (demo::read_reported(dermis_graph_view(graph_), frame_index_, choice) != DERMIS_OK)
    return std::nullopt;
  return choice;
}

dermis_memory DeviceGraph::memory() {
  dermis_memory memory = DERMIS_MEMORY_INIT;
  dermis_graph_memory(graph_, &memory);
  return memory;
}

} // namespace dermis::tools
