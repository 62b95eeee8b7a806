/* A host that inserts its own pass into the graph. It registers a pass type, and an overlay inserts
 * a pass of this type between those of the library. The library calls the pass with its images and
 * with all barriers in place. C99 and C++.
 * usage: host_pass configs/graphs/burley.json configs/profiles/skin.json
 * integration/examples/host_pass.json */
#include "headless.h"

#include "host_pass.spv.h"

#include <dermis/dermis.h>

enum { SIDE = 64, MOST = 64, TILE = 8, MAX_FILE_BYTES = 65536 };

static void check(dermis_result result, const char* call) {
  if (result >= 0) return; /* positive results are no errors */
  fprintf(stderr, "%s: ", call);
  headless_die(dermis_result_name(result), dermis_last_error());
}

static void DERMIS_CALL say(void* user, const dermis_message* message) {
  static const char* const severity[] = {"note", "warning", "error"};
  (void)user;
  if (message->line != 0) fprintf(stderr, "%s:%u:%u: ", message->file, message->line, message->column);
  fprintf(stderr, "%s: %s\n", severity[message->severity], message->text);
}

/* ---- the pass: a pipeline, and a set that points to the images at its two ports ---- */

/* Push constants of host_pass.comp. */
typedef struct tone_constants {
  int32_t rect[4]; /* x, y, width, height of the rendered part, pixels */
  float level;
} tone_constants;

typedef struct tone {
  VkDevice device;
  VkDescriptorSetLayout set_layout;
  VkDescriptorPool pool;
  /* The set for the only frame of this example; an engine needs a set per frame in flight. */
  VkDescriptorSet set;
  VkPipelineLayout layout;
  VkPipeline pipeline;
} tone;

static tone make_tone(const headless* host) {
  tone made;
  HEADLESS_STRUCT(VkDescriptorSetLayoutCreateInfo, set_info, DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  HEADLESS_STRUCT(VkDescriptorPoolCreateInfo, pool_info, DESCRIPTOR_POOL_CREATE_INFO);
  HEADLESS_STRUCT(VkDescriptorSetAllocateInfo, allocate, DESCRIPTOR_SET_ALLOCATE_INFO);
  HEADLESS_STRUCT(VkPipelineLayoutCreateInfo, layout_info, PIPELINE_LAYOUT_CREATE_INFO);
  HEADLESS_STRUCT(VkShaderModuleCreateInfo, module_info, SHADER_MODULE_CREATE_INFO);
  HEADLESS_STRUCT(VkComputePipelineCreateInfo, info, COMPUTE_PIPELINE_CREATE_INFO);
  HEADLESS_STRUCT(VkPipelineShaderStageCreateInfo, stage, PIPELINE_SHADER_STAGE_CREATE_INFO);
  const VkDescriptorSetLayoutBinding bindings[2] = {
      {0, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, 1, VK_SHADER_STAGE_COMPUTE_BIT, NULL},
      {1, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1, VK_SHADER_STAGE_COMPUTE_BIT, NULL}};
  const VkDescriptorPoolSize sizes[2] = {{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, 1},
                                         {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1}};
  const VkPushConstantRange constants = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(tone_constants)};
  made.device = host->device;
  set_info.bindingCount = 2;
  set_info.pBindings = bindings;
  HEADLESS_CHECK(vkCreateDescriptorSetLayout(host->device, &set_info, NULL, &made.set_layout));
  pool_info.maxSets = 1;
  pool_info.poolSizeCount = 2;
  pool_info.pPoolSizes = sizes;
  HEADLESS_CHECK(vkCreateDescriptorPool(host->device, &pool_info, NULL, &made.pool));
  allocate.descriptorPool = made.pool;
  allocate.descriptorSetCount = 1;
  allocate.pSetLayouts = &made.set_layout;
  HEADLESS_CHECK(vkAllocateDescriptorSets(host->device, &allocate, &made.set));
  layout_info.setLayoutCount = 1;
  layout_info.pSetLayouts = &made.set_layout;
  layout_info.pushConstantRangeCount = 1;
  layout_info.pPushConstantRanges = &constants;
  HEADLESS_CHECK(vkCreatePipelineLayout(host->device, &layout_info, NULL, &made.layout));
  module_info.codeSize = sizeof host_pass_spirv;
  module_info.pCode = host_pass_spirv;
  HEADLESS_CHECK(vkCreateShaderModule(host->device, &module_info, NULL, &stage.module));
  stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  stage.pName = "main";
  info.stage = stage;
  info.layout = made.layout;
  HEADLESS_CHECK(vkCreateComputePipelines(host->device, VK_NULL_HANDLE, 1, &info, NULL, &made.pipeline));
  vkDestroyShaderModule(host->device, stage.module, NULL);
  return made;
}

static void free_tone(tone* pass) {
  vkDestroyPipeline(pass->device, pass->pipeline, NULL);
  vkDestroyPipelineLayout(pass->device, pass->layout, NULL);
  vkDestroyDescriptorPool(pass->device, pass->pool, NULL);
  vkDestroyDescriptorSetLayout(pass->device, pass->set_layout, NULL);
}

/* Called by dermis_view_record. The ports come in the order in which the pass type declares them. */
static void DERMIS_CALL record_tone(void* user, const dermis_pass_call* call) {
  const tone* pass = (const tone*)user;
  tone_constants constants;
  VkDescriptorImageInfo images[2];
  VkWriteDescriptorSet writes[2];
  uint32_t i;
  memset(images, 0, sizeof images);
  memset(writes, 0, sizeof writes);
  for (i = 0; i < 2; ++i) {
    images[i].imageView = call->ports[i].view;
    images[i].imageLayout = call->ports[i].layout;
    writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[i].dstSet = pass->set;
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType = i == 0 ? VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    writes[i].pImageInfo = &images[i];
  }
  vkUpdateDescriptorSets(pass->device, 2, writes, 0, NULL);
  vkCmdBindPipeline(call->command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE, pass->pipeline);
  vkCmdBindDescriptorSets(call->command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE, pass->layout, 0, 1,
                          &pass->set, 0, NULL);
  constants.rect[0] = (int32_t)call->rect_x;
  constants.rect[1] = (int32_t)call->rect_y;
  constants.rect[2] = (int32_t)call->rect_width;
  constants.rect[3] = (int32_t)call->rect_height;
  constants.level = (float)call->settings[0];
  vkCmdPushConstants(call->command_buffer, pass->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
                     sizeof constants, &constants);
  vkCmdDispatch(call->command_buffer, (call->rect_width + TILE - 1) / TILE,
                (call->rect_height + TILE - 1) / TILE, 1);
  printf("the host records '%s' at %ux%u, level %.2f\n", call->pass, call->rect_width, call->rect_height,
         (double)constants.level);
}

static void register_tone(dermis_context context, tone* pass) {
  dermis_port ports[2] = {DERMIS_PORT_INIT, DERMIS_PORT_INIT};
  dermis_pass_setting level = DERMIS_PASS_SETTING_INIT;
  dermis_pass_type type = DERMIS_PASS_TYPE_INIT;
  ports[0].name = "light";
  ports[0].usage = DERMIS_PORT_SAMPLED_IMAGE;
  ports[1].name = "toned";
  ports[1].usage = DERMIS_PORT_STORAGE_IMAGE_WRITE;
  level.name = "level";
  level.type = DERMIS_PASS_SETTING_REAL;
  level.default_value = 1.0;
  level.maximum = 100.0;
  type.name = "example.tone";
  type.doc = "light above a level becomes warmer";
  type.ports = ports;
  type.port_count = 2;
  type.settings = &level;
  type.setting_count = 1;
  type.record = record_tone;
  type.user = pass;
  check(dermis_register_pass_type(context, &type), "dermis_register_pass_type");
}

/* ---- the host, as in minimal.c ---- */

static VkClearColorValue contents_of(const char* slot) {
  VkClearColorValue value;
  memset(&value, 0, sizeof value);
  if (strcmp(slot, "material") == 0) value.uint32[0] = 1;
  if (strcmp(slot, "depth") == 0) value.float32[0] = 0.5f;
  if (strcmp(slot, "lighting") == 0) value.float32[0] = value.float32[1] = value.float32[2] = 1.0f;
  return value;
}

static dermis_source source_of(const char* path, char* buffer) {
  dermis_source source = DERMIS_SOURCE_INIT;
  source.name = path;
  source.text = buffer;
  source.length = headless_read_file(path, buffer, MAX_FILE_BYTES);
  return source;
}

int main(int argc, char** argv) {
  static char graph_text[MAX_FILE_BYTES], profile_text[MAX_FILE_BYTES], overlay_text[MAX_FILE_BYTES];
  const char* unbound[] = {"albedo", "scatter_scale", "scattered_light"};
  const dermis_image_state general = {VK_IMAGE_LAYOUT_GENERAL, 0, VK_PIPELINE_STAGE_2_CLEAR_BIT,
                                      VK_ACCESS_2_TRANSFER_WRITE_BIT, 0};
  dermis_context_desc context_desc = DERMIS_CONTEXT_DESC_INIT;
  dermis_graph_desc graph_desc = DERMIS_GRAPH_DESC_INIT;
  dermis_profile skin = DERMIS_PROFILE_INIT;
  dermis_slot_format depth = DERMIS_SLOT_FORMAT_INIT;
  dermis_slot slots[MOST] = {DERMIS_SLOT_INIT};
  dermis_image_binding bindings[MOST];
  dermis_frame frame = DERMIS_FRAME_INIT;
  dermis_source overlay;
  dermis_context context;
  dermis_graph graph;
  uint32_t i, slot_count = MOST;
  tone pass;
  headless host = headless_create();
  if (argc != 4) headless_die("usage", "host_pass GRAPH.json PROFILE.json OVERLAY.json");
  pass = make_tone(&host);
  context_desc.instance = host.instance;
  context_desc.physical_device = host.gpu;
  context_desc.device = host.device;
  context_desc.get_instance_proc_addr = vkGetInstanceProcAddr;
  context_desc.log = say;
  check(dermis_context_create(&context_desc, &context), "dermis_context_create");
  register_tone(context, &pass);

  skin.id = 1;
  skin.source = source_of(argv[2], profile_text);
  depth.name = "depth";
  depth.format = VK_FORMAT_R32_SFLOAT;
  overlay = source_of(argv[3], overlay_text);
  graph_desc.source = source_of(argv[1], graph_text);
  graph_desc.overlays = &overlay;
  graph_desc.width = graph_desc.height = SIDE;
  graph_desc.profiles = &skin;
  graph_desc.formats = &depth;
  graph_desc.overlay_count = graph_desc.profile_count = graph_desc.format_count = 1;
  graph_desc.unbound = unbound;
  graph_desc.unbound_count = 3;
  check(dermis_graph_create(context, &graph_desc, &graph, NULL), "dermis_graph_create");

  check(dermis_graph_slots(graph, &slot_count, slots), "dermis_graph_slots");
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
  frame.clip_from_view[0] = 2.0f;
  frame.clip_from_view[5] = -2.0f;
  frame.clip_from_view[10] = frame.clip_from_view[14] = -1.0f;
  frame.clip_from_view[11] = -0.1f;
  check(dermis_view_record(dermis_graph_view(graph), &frame), "dermis_view_record");
  headless_submit_and_wait(&host);
  dermis_graph_destroy(graph);
  dermis_context_destroy(context);
  free_tone(&pass);
  headless_destroy(&host);
  return 0;
}
