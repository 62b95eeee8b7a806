#include "integration/tools/command/bench/record/counted_host.hpp"

#include "integration/examples/demo_engine/dermis_calls.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

// Sets a perspective camera that looks down -z: focal length 2 at half height 1, near plane at 0.1
// units.
void set_camera(dermis_frame& frame) {
  for (float* matrix : {frame.clip_from_view, frame.previous_clip_from_view}) {
    matrix[0] = 2.0F;
    matrix[5] = -2.0F;
    matrix[10] = matrix[14] = -1.0F;
    matrix[11] = -0.1F;
  }
  for (float* matrix : {frame.view_from_world, frame.previous_view_from_world})
    matrix[0] = matrix[5] = matrix[10] = matrix[15] = 1.0F;
}

} // namespace

CountedHost::~CountedHost() {
  dermis_graph_destroy(graph_);
  dermis_context_destroy(context_);
}

std::string CountedHost::open(const CountedInput& input) {
  dermis_context_desc context = DERMIS_CONTEXT_DESC_INIT;
  context.flags = DERMIS_CONTEXT_TIMINGS;
  context.frames_in_flight = image_sets;
  context.instance = device_.instance();
  context.physical_device = device_.physical();
  context.device = device_.device();
  context.get_instance_proc_addr = NullDevice::loader();
  if (dermis_context_create(&context, &context_) != DERMIS_OK) return dermis_last_error();
  if (input.hooks.prepare)
    if (auto prepared = input.hooks.prepare(context_); !prepared) return prepared.error().text;

  dermis_profile profile = DERMIS_PROFILE_INIT;
  profile.id = 1;
  profile.source = demo::source_of(input.profile_name, input.profile);
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  desc.source = demo::source_of(input.name, input.graph);
  desc.width = input.width;
  desc.height = input.height;
  desc.profiles = &profile;
  desc.profile_count = 1;
  if (std::string problem = create(desc); !problem.empty()) return problem;
  std::vector<std::string> others; // slots other than images
  for (const dermis_slot& slot : slots())
    if (slot.type != DERMIS_SLOT_IMAGE) others.emplace_back(slot.name);
  if (!others.empty()) {
    std::vector<const char*> unbound;
    for (const std::string& name : others)
      unbound.push_back(name.c_str());
    desc.unbound = unbound.data();
    desc.unbound_count = static_cast<uint32_t>(unbound.size());
    dermis_graph_destroy(graph_);
    graph_ = nullptr;
    if (std::string problem = create(desc); !problem.empty()) return problem;
  }
  dermis_budget budget = DERMIS_BUDGET_INIT;
  budget.milliseconds = input.budget_ms;
  if (dermis_graph_set_budget(graph_, &budget, nullptr) != DERMIS_OK) return dermis_last_error();
  return bind();
}

std::string CountedHost::create(const dermis_graph_desc& desc) {
  dermis_report report = nullptr;
  const dermis_result result = dermis_graph_create(context_, &desc, &graph_, &report);
  std::string text = dermis_report_text(report);
  dermis_report_destroy(report);
  if (result == DERMIS_OK) return "";
  return text.empty() ? dermis_last_error() : text; // errors of arguments are in no report
}

std::vector<dermis_slot> CountedHost::slots() const {
  uint32_t count = 0;
  if (dermis_graph_slots(graph_, &count, nullptr) != DERMIS_OK) return {};
  std::vector<dermis_slot> slots(count, dermis_slot DERMIS_SLOT_INIT);
  return dermis_graph_slots(graph_, &count, slots.data()) == DERMIS_OK ? slots
                                                                       : std::vector<dermis_slot>();
}

std::string CountedHost::bind() {
  const std::vector<dermis_slot> all = slots();
  if (all.empty()) return dermis_last_error();
  for (std::vector<dermis_image_binding>& set : bindings_)
    for (const dermis_slot& slot : all) {
      if (slot.bound == 0) continue;
      dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
      binding.slot = slot.id;
      binding.format = slot.format;
      binding.width = slot.width;
      binding.height = slot.height;
      binding.image = device_.make_image();
      binding.view = device_.make_view();
      binding.content_id = ++last_image_;
      binding.before = {VK_IMAGE_LAYOUT_GENERAL, 0, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                        VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, 0};
      binding.after = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 0,
                       VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                       0};
      set.push_back(binding);
    }
  frame_.command_buffer = device_.command_buffer();
  set_camera(frame_);
  return "";
}

dermis_result CountedHost::record_frame() {
  ++frame_.frame_index;
  frame_.completed_frame_index = frame_.frame_index - 1;
  const std::vector<dermis_image_binding>& set = bindings_[frame_.frame_index % image_sets];
  frame_.bindings = set.data();
  frame_.binding_count = static_cast<uint32_t>(set.size());
  return dermis_view_record(dermis_graph_view(graph_), &frame_);
}

bool CountedHost::chooses() const {
  uint32_t count = 0;
  const dermis_view view = dermis_graph_view(graph_);
  if (dermis_view_settings(view, &count, nullptr) != DERMIS_OK || count == 0) return false;
  std::vector<dermis_setting> settings(count, dermis_setting DERMIS_SETTING_INIT);
  return dermis_view_settings(view, &count, settings.data()) == DERMIS_OK &&
         std::any_of(settings.begin(), settings.end(),
                     [](const dermis_setting& setting) { return setting.chosen != 0; });
}

uint32_t CountedHost::passes() const {
  uint32_t count = 0;
  return dermis_view_timings(dermis_graph_view(graph_), frame_.completed_frame_index, &count,
                             nullptr) == DERMIS_OK
             ? count
             : 0;
}

} // namespace dermis::tools
