/* A lit wall of skin. usage: minimal configs/graphs/burley.json configs/profiles/skin.json */
#include "headless.h"

#include <dermis/dermis.h>

enum { SIDE = 64, MOST = 64 };

static void check(dermis_result result) {
  if (result < 0) headless_die(dermis_result_name(result), dermis_last_error()); /* > 0: no error */
}

static void DERMIS_CALL say(void* user, const dermis_message* message) {
  static const char* const severity[] = {"note", "warning", "error"};
  (void)user;
  if (message->line != 0) fprintf(stderr, "%s:%u:%u: ", message->file, message->line, message->column);
  fprintf(stderr, "%s: %s\n", severity[message->severity], message->text);
}

/* The G-buffer of the example: light 1 everywhere, half a metre away, profile 1. */
static VkClearColorValue contents_of(const char* slot) {
  VkClearColorValue value = {{0.0f}};
  if (strcmp(slot, "material") == 0) value.uint32[0] = 1;
  if (strcmp(slot, "depth") == 0) value.float32[0] = 0.5f;
  if (strcmp(slot, "lighting") == 0) value.float32[0] = value.float32[1] = value.float32[2] = 1.0f;
  return value;
}

int main(int argc, char** argv) {
  static char graph_text[65536], profile_text[65536];
  const char* unbound[] = {"albedo", "scatter_scale", "scattered_light"};
  const dermis_image_state general = {VK_IMAGE_LAYOUT_GENERAL, 0,
                                      VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, 0};
  dermis_context_desc context_desc = DERMIS_CONTEXT_DESC_INIT;
  dermis_graph_desc graph_desc = DERMIS_GRAPH_DESC_INIT;
  dermis_profile skin = DERMIS_PROFILE_INIT;
  dermis_slot_format depth = DERMIS_SLOT_FORMAT_INIT;
  dermis_slot slots[MOST] = {DERMIS_SLOT_INIT};
  dermis_pass_timing timings[MOST] = {DERMIS_PASS_TIMING_INIT};
  dermis_image_binding bindings[MOST];
  dermis_frame frame = DERMIS_FRAME_INIT;
  dermis_context context;
  dermis_graph graph;
  uint32_t i, slot_count = MOST, pass_count = MOST;
  headless host = headless_create();
  if (argc != 3) headless_die("usage", "minimal GRAPH.json PROFILE.json");
  context_desc.flags = DERMIS_CONTEXT_TIMINGS;
  context_desc.instance = host.instance;
  context_desc.physical_device = host.gpu;
  context_desc.device = host.device;
  context_desc.get_instance_proc_addr = vkGetInstanceProcAddr;
  context_desc.log = say;
  check(dermis_context_create(&context_desc, &context));

  skin.id = 1;
  skin.source.name = argv[2];
  skin.source.text = profile_text;
  skin.source.length = headless_read_file(argv[2], profile_text, sizeof profile_text);
  depth.name = "depth";
  depth.format = VK_FORMAT_R32_SFLOAT;
  graph_desc.source.name = argv[1];
  graph_desc.source.text = graph_text;
  graph_desc.source.length = headless_read_file(argv[1], graph_text, sizeof graph_text);
  graph_desc.width = graph_desc.height = SIDE;
  graph_desc.profiles = &skin;
  graph_desc.formats = &depth;
  graph_desc.profile_count = graph_desc.format_count = 1;
  graph_desc.unbound = unbound;
  graph_desc.unbound_count = 3;
  check(dermis_graph_create(context, &graph_desc, &graph, NULL));

  check(dermis_graph_slots(graph, &slot_count, slots));
  for (i = 0; i < slot_count; ++i) {
    dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
    if (!slots[i].bound) continue;
    binding.slot = slots[i].id;
    binding.format = slots[i].format;
    binding.width = binding.height = SIDE;
    binding.image = headless_image(&host, slots[i].format, SIDE, SIDE, slots[i].usage,
                                   contents_of(slots[i].name), &binding.view);
    binding.before = binding.after = general;
    bindings[frame.binding_count++] = binding;
  }
  frame.command_buffer = host.commands;
  frame.bindings = bindings;
  frame.frame_index = 1;
  frame.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
  frame.clip_from_view[0] = 2.0f; /* perspective; the tangent of half the field of view is 1/2 */
  frame.clip_from_view[5] = -2.0f;
  frame.clip_from_view[10] = frame.clip_from_view[14] = -1.0f;
  frame.clip_from_view[11] = -0.1f;
  check(dermis_view_record(dermis_graph_view(graph), &frame));
  headless_submit_and_wait(&host);
  check(dermis_view_timings(dermis_graph_view(graph), 1, &pass_count, timings));
  for (i = 0; i < pass_count && timings[i].pass != NULL; ++i)
    printf("%-12s %8.3f ms\n", timings[i].pass, (double)timings[i].nanoseconds * 1e-6);
  dermis_graph_destroy(graph);
  dermis_context_destroy(context);
  headless_destroy(&host);
  return 0;
}
