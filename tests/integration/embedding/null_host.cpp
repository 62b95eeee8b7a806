#include "tests/integration/embedding/null_host.hpp"

#include "tests/integration/abi/sources.hpp"

namespace dermis::abi_test {
namespace {

const std::string& own_graph() { // Read when the first graph is made.
  static const std::string text = read_text("configs/graphs/burley.json");
  return text;
}

} // namespace

NullHost::~NullHost() {
  destroy();
}

void NullHost::destroy() {
  dermis_graph_destroy(graph);
  dermis_context_destroy(context);
  graph = nullptr;
  context = nullptr;
}

dermis_context_desc NullHost::context_desc() {
  dermis_context_desc desc = DERMIS_CONTEXT_DESC_INIT;
  desc.flags = DERMIS_CONTEXT_TIMINGS;
  desc.instance = device.instance();
  desc.physical_device = device.physical();
  desc.device = device.device();
  desc.get_instance_proc_addr = NullDevice::loader();
  return desc;
}

dermis_result NullHost::make_context(const dermis_context_desc& desc) {
  return dermis_context_create(&desc, &context);
}

dermis_result NullHost::make_graph(uint32_t side) {
  static const std::string overlay_text = read_text("configs/overlays/accumulate.json");
  dermis_profile profile = skin_profile();
  const dermis_source overlay = source_of(overlay_text, "accumulate.json");
  dermis_graph_desc desc = graph_desc(own_graph(), "burley.json", side);
  desc.profiles = &profile;
  desc.profile_count = 1;
  desc.overlays = &overlay;
  desc.overlay_count = 1;
  return dermis_graph_create(context, &desc, &graph, nullptr);
}

dermis_result NullHost::start() {
  dermis_result result = make_context(context_desc());
  if (result == DERMIS_OK) result = make_graph();
  if (result == DERMIS_OK) make_bindings();
  return result;
}

dermis_image_binding NullHost::image_for(const dermis_slot& slot) {
  dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
  binding.slot = slot.id;
  binding.format = slot.format;
  binding.width = slot.width;
  binding.height = slot.height;
  binding.image = device.make_image();
  binding.view = device.make_view();
  binding.before =
      binding.after = {VK_IMAGE_LAYOUT_GENERAL, 0, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                       VK_ACCESS_2_MEMORY_WRITE_BIT, 0};
  return binding;
}

void NullHost::make_bindings() {
  bindings_.clear();
  for (const dermis_slot& slot : slots_of(graph))
    bindings_.push_back(image_for(slot));
}

void NullHost::number_images() {
  for (dermis_image_binding& binding : bindings_)
    binding.content_id = ++last_id_;
}

void NullHost::give_up_views() {
  number_images();
  for (dermis_image_binding& binding : bindings_)
    binding.view = VK_NULL_HANDLE;
}

// Allocates nothing itself, because tests count allocations.
dermis_result NullHost::reload(const std::string& text) const {
  return reload_text(graph, source_of(text.empty() ? own_graph() : text, "burley.json"));
}

dermis_result NullHost::set_profile(const std::string& text) const {
  const dermis_source source = source_of(text, "profile.json");
  return dermis_graph_set_profile(graph, 1, &source, nullptr);
}

dermis_frame NullHost::frame_at(uint64_t index) const {
  dermis_frame frame = DERMIS_FRAME_INIT;
  frame.command_buffer = device.command_buffer();
  frame.bindings = bindings_.data();
  frame.binding_count = static_cast<uint32_t>(bindings_.size());
  frame.frame_index = index;
  frame.completed_frame_index = index - 1;
  frame.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
  frame.clip_from_view[0] = frame.clip_from_view[15] = 1.0f;
  frame.clip_from_view[5] = frame.clip_from_view[10] = -1.0f;
  return frame;
}

dermis_result NullHost::record() {
  const dermis_frame next = frame_at(last_frame + 1);
  const dermis_result result = dermis_view_record(dermis_graph_view(graph), &next);
  if (result == DERMIS_OK) ++last_frame;
  return result;
}

dermis_result NullHost::record(dermis_view view, uint64_t index) const {
  const dermis_frame next = frame_at(index);
  return dermis_view_record(view, &next);
}

uint32_t DERMIS_CALL open_kernel(void* user, const char* name, dermis_source* source) {
  static const std::string text =
      "#version 460\n#extension GL_GOOGLE_include_directive : require\n"
      "#include \"common/subsurface_combine.bindings.glsl\"\n"
      "layout(local_size_x = 8, local_size_y = 8) in;\nvoid main() {}\n";
  if (std::string(name) != "common/subsurface_combine.comp") return 0;
  ++*static_cast<uint32_t*>(user);
  source->text = text.data();
  source->length = text.size();
  return 1;
}

} // namespace dermis::abi_test
