#include "integration/examples/demo_engine/render/dermis_host.hpp"

#include "integration/examples/demo_engine/dermis_calls.hpp"
#include "integration/examples/demo_engine/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace demo {

struct DermisHost {
  std::shared_ptr<dermis_context_t> context; // the device's context, which its graphs share
  dermis_graph graph = nullptr;
  std::vector<dermis_slot> slots;
  // copies, because a reload frees the strings of the replaced graph's slots
  std::vector<std::string> slot_names;
  std::vector<std::string> warnings;
  Delivery shaders;                   // called as long as the graph lives
  std::function<Result<>()> recorded; // called after each recorded frame if not empty
};

namespace {

constexpr uint32_t frames_in_flight = 2;

std::optional<Target> target_of(std::string_view slot) {
  for (size_t i = 0; i < target_count; ++i)
    if (!slot.empty() && target_info(static_cast<Target>(i)).slot == slot)
      return static_cast<Target>(i);
  return std::nullopt;
}

// Reads the files of the graph; formats and unbound slots are not known yet.
Result<GraphRequest> read_request(const DermisDesc& desc) {
  GraphRequest request;
  request.graph_name = desc.graph_file;
  request.graph_text = desc.graph_text;
  if (desc.graph_text.empty()) {
    auto graph = read_text_file(desc.graph_file);
    if (!graph) return graph.error();
    request.graph_text = graph.take();
  }
  for (const ScatteringProfile& profile : desc.profiles) {
    auto text = read_text_file(profile.file);
    if (!text) return text.error();
    request.profiles.push_back({profile.id, profile.file, text.take()});
  }
  request.overlays = desc.overlays;
  request.include = desc.include;
  request.width = desc.width;
  request.height = desc.height;
  request.pixel_aspect = desc.pixel_aspect;
  return request;
}

// The part of the ray scene that a slot binds, by the name of the slot.
enum class RayPart : uint8_t { none, structure, vertices, indices, instances, lights };

RayPart ray_part_of(const dermis_slot& slot) {
  const std::string_view name = slot.name;
  if (slot.type == DERMIS_SLOT_ACCELERATION_STRUCTURE)
    return name == "scene" ? RayPart::structure : RayPart::none;
  if (slot.type != DERMIS_SLOT_BUFFER) return RayPart::none;
  return name == "vertices"    ? RayPart::vertices
         : name == "indices"   ? RayPart::indices
         : name == "instances" ? RayPart::instances
         : name == "lights"    ? RayPart::lights
                               : RayPart::none;
}

bool is_rays(const dermis_slot& slot) {
  return ray_part_of(slot) != RayPart::none;
}

Result<> query_slots(DermisHost& host) {
  uint32_t count = 0;
  dermis_result result = dermis_graph_slots(host.graph, &count, nullptr);
  if (result != DERMIS_OK) return dermis_error("dermis_graph_slots", result);
  host.slots.assign(count, dermis_slot DERMIS_SLOT_INIT);
  if (count > 0) result = dermis_graph_slots(host.graph, &count, host.slots.data());
  if (result != DERMIS_OK) return dermis_error("dermis_graph_slots", result);
  host.slot_names.clear();
  for (const dermis_slot& slot : host.slots)
    host.slot_names.emplace_back(slot.name);
  return success();
}

// Builds the graph with the formats of the known slots. `unbound` may only name slots of the graph.
Result<> build_graph(DermisHost& host, GraphRequest& request, std::vector<std::string> unbound) {
  for (const std::string& name : host.slot_names)
    if (const auto target = target_of(name))
      request.formats.emplace_back(name, target_info(*target).format);
  request.unbound = std::move(unbound);
  Report report;
  const auto graph = create_graph(host.context.get(), request, report);
  if (!graph) return graph.error();
  host.warnings.clear();
  for (uint32_t i = 0; i < dermis_report_count(report.handle); ++i) {
    dermis_message message = DERMIS_MESSAGE_INIT;
    if (dermis_report_message(report.handle, i, &message) == DERMIS_OK)
      host.warnings.push_back(
          fmt::format("{}:{}:{}: {}", message.file, message.line, message.column, message.text));
  }
  dermis_graph_destroy(host.graph);
  host.graph = *graph;
  return query_slots(host);
}

Result<> set_budget(DermisHost& host, const DermisDesc& desc) {
  const Budget& given = desc.budget;
  if (given.ms == 0 && !given.deterministic && given.calibration.text.empty() &&
      given.errors.text.empty())
    return success();
  const dermis_source calibration = source_of(given.calibration.name, given.calibration.text);
  const dermis_source errors = source_of(given.errors.name, given.errors.text);
  dermis_budget budget = DERMIS_BUDGET_INIT;
  budget.milliseconds = static_cast<float>(given.ms);
  budget.percentile = static_cast<float>(given.percentile);
  if (given.deterministic) budget.flags |= DERMIS_BUDGET_DETERMINISTIC;
  if (given.trials == Trials::cuts) budget.flags |= DERMIS_BUDGET_TRIALS_AT_CUTS;
  if (given.trials == Trials::never) budget.flags |= DERMIS_BUDGET_NO_TRIALS;
  budget.calibration = given.calibration.text.empty() ? nullptr : &calibration;
  budget.errors = given.errors.text.empty() ? nullptr : &errors;
  Report report;
  const dermis_result result = dermis_graph_set_budget(host.graph, &budget, &report.handle);
  if (result != DERMIS_OK) return dermis_error("dermis_graph_set_budget", result, report.handle);
  return success();
}

Result<> use_shaders(DermisHost& host, const DermisDesc& desc) {
  if (!desc.shaders) return success();
  host.shaders = {desc.shaders};
  Report report;
  const dermis_result result =
      dermis_graph_reload_shaders(host.graph, deliver, &host.shaders, &report.handle);
  host.shaders.delivered.clear();
  if (result != DERMIS_OK)
    return dermis_error("dermis_graph_reload_shaders", result, report.handle);
  return success();
}

// Returns the slots that this engine does not fill. Errors: input (the graph requires one of them).
Result<std::vector<std::string>> find_unbound(const DermisHost& host, const DermisDesc& desc,
                                              bool rays) {
  std::vector<std::string> unbound;
  for (const dermis_slot& slot : host.slots) {
    if (rays && is_rays(slot)) continue;
    const auto target = target_of(slot.name);
    const bool left_out =
        std::find(desc.unbound.begin(), desc.unbound.end(), slot.name) != desc.unbound.end();
    if (left_out && slot.required)
      return Error{ErrorKind::usage, fmt::format("graph '{}' needs '{}': it cannot be unbound",
                                                 desc.graph_file, slot.name)};
    if (target && !left_out && (target != Target::sampling || desc.sampling) &&
        (target != Target::tile_class || desc.tile_class))
      continue;
    if (slot.required)
      return Error{
          ErrorKind::input,
          fmt::format(
              "graph '{}' wants '{}' bound, which the demo engine does not make; it offers "
              "lighting, depth, normal, material, albedo, velocity, thickness, back_lighting and "
              "scattered_light",
              desc.graph_file, slot.name)};
    unbound.emplace_back(slot.name);
  }
  for (const std::string& name : desc.unbound)
    if (std::find(host.slot_names.begin(), host.slot_names.end(), name) == host.slot_names.end())
      return Error{ErrorKind::usage,
                   fmt::format("graph '{}' has no slot '{}'; it has {}", desc.graph_file, name,
                               fmt::join(host.slot_names, ", "))};
  return unbound;
}

} // namespace

void DermisHostDeleter::operator()(DermisHost* host) const {
  dermis_graph_destroy(host->graph);
  delete host;
}

Result<DermisHandle> create_dermis_host(VulkanHost& vulkan, const DermisDesc& desc,
                                        KnownSlots* known) {
  auto request = read_request(desc);
  if (!request) return request.error();
  DermisHandle host(new DermisHost);
  if (auto ready = make_context(vulkan, frames_in_flight, true, vulkan.engine_context, desc.hooks);
      !ready)
    return ready.error();
  host->context = vulkan.engine_context;
  host->recorded = desc.hooks.recorded;
  const bool whole = desc.overlays.empty() && !desc.include && !desc.sampling && !desc.tile_class &&
                     desc.unbound.empty();
  if (!whole) known = nullptr;
  std::vector<std::string> unbound;
  if (known && known->graph == request->graph_text) {
    host->slot_names = known->names;
    unbound = known->unbound;
  } else {
    // The slots are known only after the graph was built. The first build gives their names; the
    // second uses this engine's formats and leaves out the slots that it cannot bind.
    if (auto done = build_graph(*host, *request, {}); !done) return done.error();
    auto found = find_unbound(*host, desc, vulkan.ray_query);
    if (!found) return found.error();
    unbound = found.take();
    if (known) *known = {request->graph_text, host->slot_names, unbound};
  }
  if (auto done = build_graph(*host, *request, std::move(unbound)); !done) return done.error();
  for (const auto& [name, json] : desc.settings) {
    Report report;
    const dermis_result set =
        dermis_graph_set_setting(host->graph, name.c_str(), json.c_str(), &report.handle);
    if (set == DERMIS_OK) continue;
    Error error = dermis_error("dermis_graph_set_setting", set, report.handle);
    // names and values come from the user
    if (error.kind != ErrorKind::environment) error.kind = ErrorKind::usage;
    return error;
  }
  if (auto done = set_budget(*host, desc); !done) return done.error();
  if (auto done = use_shaders(*host, desc); !done) return done.error();
  // A setting may change the slots, and the replaced plan owns the old slots and their names.
  if (auto done = query_slots(*host); !done) return done.error();
  return host;
}

Result<bool> reload_graph(DermisHost& host, const std::string& text) {
  const std::string name = "reloaded graph";
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.source = source_of(name, text);
  desc.keep = DERMIS_KEEP_ALL & ~DERMIS_KEEP_SOURCE;
  Report report;
  const dermis_result result = dermis_graph_reload(host.graph, &desc, &report.handle);
  if (result == DERMIS_ERROR_CONFIG) return false;
  if (result != DERMIS_OK) return dermis_error("dermis_graph_reload", result, report.handle);
  if (auto done = query_slots(host); !done) return done.error();
  return true;
}

std::array<VkImageUsageFlags, target_count> usage_for_graph(const DermisHost& host) {
  std::array<VkImageUsageFlags, target_count> usage{};
  for (const dermis_slot& slot : host.slots)
    if (const auto target = target_of(slot.name)) usage[static_cast<size_t>(*target)] |= slot.usage;
  return usage;
}

namespace {

bool writes(const DermisHost& host, Target target) {
  return std::any_of(host.slots.begin(), host.slots.end(), [&](const dermis_slot& slot) {
    return slot.written && slot.bound && target_of(slot.name) == target;
  });
}

} // namespace

bool exports_light(const DermisHost& host) {
  return writes(host, Target::scattered);
}

bool uses_rays(const DermisHost& host) {
  return std::any_of(host.slots.begin(), host.slots.end(),
                     [](const dermis_slot& slot) { return slot.bound && is_rays(slot); });
}

bool exports_sampling(const DermisHost& host) {
  return writes(host, Target::sampling);
}

bool exports_tile_class(const DermisHost& host) {
  return writes(host, Target::tile_class);
}

Scattering scattering_of(const DermisHost& host) {
  const bool with_albedo =
      std::any_of(host.slots.begin(), host.slots.end(), [](const dermis_slot& slot) {
        return slot.bound != 0 && std::string_view(slot.name) == "albedo";
      });
  // Without albedo the graph writes irradiance, like that of a frame without a graph.
  if (writes(host, Target::lighting)) return with_albedo ? Scattering::in_place : Scattering::none;
  return exports_light(host) ? Scattering::apart : Scattering::none;
}

const std::vector<std::string>& warnings_of(const DermisHost& host) {
  return host.warnings;
}

namespace {

// Binds a part of the ray scene. This engine waits for its uploads and builds, so no further wait
// is needed.
void bind_rays(const dermis_slot& slot, const RayScene& rays,
               std::vector<dermis_buffer_binding>& buffers,
               dermis_acceleration_structure_binding& structure) {
  const RayPart part = ray_part_of(slot);
  if (part == RayPart::structure) {
    structure.slot = slot.id;
    structure.structure = rays.top.handle;
    structure.before.stages = structure.after.stages = ray_build_stages;
    structure.before.access = structure.after.access = ray_build_access;
    return;
  }
  const Buffer& buffer = part == RayPart::vertices    ? rays.vertices
                         : part == RayPart::indices   ? rays.indices
                         : part == RayPart::instances ? rays.instances
                                                      : rays.lights;
  dermis_buffer_binding& binding =
      buffers.emplace_back(dermis_buffer_binding DERMIS_BUFFER_BINDING_INIT);
  binding.slot = slot.id;
  binding.buffer = buffer.buffer;
  binding.bytes = buffer.size / slot.stride * slot.stride;
  binding.before.stages = binding.after.stages = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  binding.before.access = binding.after.access = VK_ACCESS_2_TRANSFER_WRITE_BIT;
}

// Errors: input (the graph needs larger images than those of this engine).
Result<std::vector<dermis_image_binding>> bind_images(const DermisHost& host,
                                                      const Renderer& renderer) {
  dermis_image_state rests{};
  rests.layout = resting.layout;
  rests.stages = resting.stages;
  rests.access = resting.access;
  std::vector<dermis_image_binding> bindings;
  for (const dermis_slot& slot : host.slots) {
    const auto target = target_of(slot.name);
    if (!target || !slot.bound) continue;
    const Image& image = renderer[*target];
    if (image.width < slot.width || image.height < slot.height)
      return Error{ErrorKind::input,
                   fmt::format("the graph needs '{}' with {}x{} pixels, but the demo engine makes "
                               "images of the view's size, {}x{}: 'size', 'align' and 'border' of "
                               "imports must not ask for more",
                               slot.name, slot.width, slot.height, image.width, image.height)};
    dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
    binding.slot = slot.id;
    binding.format = image.format;
    binding.image = image.image;
    binding.view = image.view;
    binding.width = image.width;
    binding.height = image.height;
    binding.before = rests;
    binding.after = rests;
    binding.content_id = image.id;
    bindings.push_back(binding);
  }
  return bindings;
}

} // namespace

Result<> record_graph(DermisHost& host, const Renderer& renderer, const SceneState& state,
                      VkCommandBuffer commands, uint64_t frame_index) {
  auto bindings = bind_images(host, renderer);
  if (!bindings) return bindings.error();
  std::vector<dermis_buffer_binding> buffers;
  dermis_acceleration_structure_binding structure = DERMIS_ACCELERATION_STRUCTURE_BINDING_INIT;
  for (const dermis_slot& slot : host.slots)
    if (slot.bound && is_rays(slot)) bind_rays(slot, *renderer.rays, buffers, structure);
  dermis_frame frame = DERMIS_FRAME_INIT;
  frame.buffers = buffers.data();
  frame.buffer_count = static_cast<uint32_t>(buffers.size());
  frame.structures = &structure;
  frame.structure_count = structure.structure != VK_NULL_HANDLE ? 1 : 0;
  frame.command_buffer = commands;
  frame.bindings = (*bindings).data();
  frame.binding_count = static_cast<uint32_t>((*bindings).size());
  frame.frame_index = frame_index;
  if (state.cut) frame.flags |= DERMIS_FRAME_RESET_HISTORY;
  frame.completed_frame_index = frame_index - 1; // this engine waits for every frame
  const auto put = [](const glm::dmat4& m, float(&rows)[16]) {
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c)
        rows[r * 4 + c] = static_cast<float>(m[c][r]);
  };
  put(state.now.clip_from_view, frame.clip_from_view);
  put(state.now.view_from_world, frame.view_from_world);
  put(state.previous.clip_from_view, frame.previous_clip_from_view);
  put(state.previous.view_from_world, frame.previous_view_from_world);
  frame.jitter_x = static_cast<float>(state.now.jitter.x);
  frame.jitter_y = static_cast<float>(state.now.jitter.y);
  frame.metres_per_unit = 1.0f;
  frame.exposure = static_cast<float>(renderer.scene->exposure);
  frame.delta_seconds = static_cast<float>(1.0 / renderer.scene->frames_per_second);
  frame.depth_kind = DERMIS_DEPTH_DEVICE;
  const dermis_result result = dermis_view_record(dermis_graph_view(host.graph), &frame);
  if (result != DERMIS_OK) return dermis_error("dermis_view_record", result);
  return host.recorded ? host.recorded() : success();
}

dermis_graph_t* graph_of(const DermisHost& host) {
  return host.graph;
}

} // namespace demo
