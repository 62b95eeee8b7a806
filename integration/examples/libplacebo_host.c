/* Dermis between the passes of another renderer. libplacebo owns instance, device, queue and
 * images. It fills the images, releases them to Dermis, and reads the picture back.
 * usage: libplacebo_host configs/graphs/burley.json configs/profiles/skin.json */
#include <dermis/dermis.h>
#include <libplacebo/vulkan.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

enum { SIDE = 64, SLOTS = 3 };

/* A binding of the graph and its libplacebo texture. */
typedef struct slot_image {
  const char* name;
  const char* format; /* name in libplacebo */
  size_t texel;       /* bytes */
  pl_tex texture;
  VkSemaphore semaphore; /* values: 1 held, 2 released */
} slot_image;

static void die(const char* what, const char* which) {
  fprintf(stderr, "%s: %s\n", what, which);
  exit(1);
}
static void check(dermis_result result, const char* call) {
  if (result != DERMIS_OK) die(call, dermis_last_error());
}
static void check_vk(VkResult result, const char* call) {
  if (result != VK_SUCCESS) die("failed", call);
}

static char* read_file(const char* path, size_t* length) {
  FILE* file = fopen(path, "rb");
  const size_t maximum = 1 << 16;
  char* text = (char*)malloc(maximum);
  if (file == NULL || text == NULL) die("cannot read", path);
  *length = fread(text, 1, maximum, file);
  fclose(file);
  return text;
}

/* Returns a half float of 0 or 1. */
static uint16_t half_bit(int one) {
  return one ? 0x3c00 : 0;
}

/* Returns the texels of a slot: light on the left half, 0.5 m away, profile 1 everywhere. */
static void* contents_of(const slot_image* slot) {
  unsigned char* texels = (unsigned char*)malloc(slot->texel * SIDE * SIDE);
  int x, y, c;
  if (texels == NULL) die("out of memory", slot->name);
  for (y = 0; y < SIDE; ++y)
    for (x = 0; x < SIDE; ++x) {
      unsigned char* at = texels + slot->texel * (size_t)(y * SIDE + x);
      const float depth = 0.5f;
      if (strcmp(slot->name, "depth") == 0) memcpy(at, &depth, sizeof depth);
      if (strcmp(slot->name, "material") == 0) *at = 1;
      if (strcmp(slot->name, "lighting") != 0) continue;
      for (c = 0; c < 4; ++c) {
        const uint16_t value = half_bit(x < SIDE / 2);
        memcpy(at + 2 * c, &value, sizeof value);
      }
    }
  return texels;
}

/* Creates a device with the requirements of Dermis through libplacebo. */
static pl_vulkan make_device(pl_log log, pl_vk_inst* instance) {
  static VkPhysicalDeviceMaintenance4Features maintenance4;
  static VkPhysicalDeviceSynchronization2Features synchronization2;
  static VkPhysicalDeviceFeatures2 features;
  struct pl_vk_inst_params instance_params = pl_vk_inst_default_params;
  struct pl_vulkan_params params = pl_vulkan_default_params;
  pl_vulkan device;
  /* libplacebo always names its objects. */
  static const char* const names[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME};
  instance_params.opt_extensions = names;
  instance_params.num_opt_extensions = 1;
  *instance = pl_vk_inst_create(log, &instance_params);
  if (*instance == NULL) die("pl_vk_inst_create", "no Vulkan instance");
  maintenance4.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES;
  maintenance4.maintenance4 = VK_TRUE;
  synchronization2.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES;
  synchronization2.synchronization2 = VK_TRUE;
  synchronization2.pNext = &maintenance4;
  features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
  features.features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
  features.pNext = &synchronization2;
  params.instance = (*instance)->instance;
  params.get_proc_addr = (*instance)->get_proc_addr;
  params.allow_software = true;
  params.async_compute = params.async_transfer = false;
  params.features = &features;
  device = pl_vulkan_create(log, &params);
  if (device == NULL) die("pl_vulkan_create", "no Vulkan device");
  return device;
}

static void make_image(pl_vulkan device, slot_image* slot) {
  VkSemaphoreTypeCreateInfo type;
  VkSemaphoreCreateInfo info;
  struct pl_tex_params params;
  void* texels = contents_of(slot);
  memset(&params, 0, sizeof params);
  params.w = params.h = SIDE;
  params.format = pl_find_named_fmt(device->gpu, slot->format);
  if (params.format == NULL) die("libplacebo has no format", slot->format);
  params.sampleable = params.host_readable = true;
  params.storable = strcmp(slot->name, "lighting") == 0;
  params.initial_data = texels;
  slot->texture = pl_tex_create(device->gpu, &params);
  if (slot->texture == NULL) die("pl_tex_create", slot->name);
  free(texels);
  memset(&type, 0, sizeof type);
  type.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO;
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  memset(&info, 0, sizeof info);
  info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO;
  info.pNext = &type;
  check_vk(vkCreateSemaphore(device->device, &info, NULL, &slot->semaphore), "vkCreateSemaphore");
}

static VkImageView make_view(pl_vulkan device, VkImage image, VkFormat format) {
  VkImageViewCreateInfo info;
  VkImageView view;
  memset(&info, 0, sizeof info);
  info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  info.image = image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  info.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
  info.subresourceRange.levelCount = info.subresourceRange.layerCount = 1;
  check_vk(vkCreateImageView(device->device, &info, NULL, &view), "vkCreateImageView");
  return view;
}

/* Waits until libplacebo releases every image, runs the commands, and signals that the images are
 * free again. */
static void submit(pl_vulkan device, VkCommandBuffer commands, slot_image* images) {
  VkSemaphoreSubmitInfo waits[SLOTS], signals[SLOTS];
  VkCommandBufferSubmitInfo buffer;
  VkSubmitInfo2 info;
  VkQueue queue;
  int i;
  memset(waits, 0, sizeof waits);
  memset(signals, 0, sizeof signals);
  memset(&buffer, 0, sizeof buffer);
  memset(&info, 0, sizeof info);
  for (i = 0; i < SLOTS; ++i) {
    waits[i].sType = signals[i].sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO;
    waits[i].semaphore = signals[i].semaphore = images[i].semaphore;
    waits[i].stageMask = signals[i].stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    waits[i].value = 1;
    signals[i].value = 2;
  }
  buffer.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  buffer.commandBuffer = commands;
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
  info.waitSemaphoreInfoCount = info.signalSemaphoreInfoCount = SLOTS;
  info.pWaitSemaphoreInfos = waits;
  info.pSignalSemaphoreInfos = signals;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &buffer;
  vkGetDeviceQueue(device->device, device->queue_graphics.index, 0, &queue);
  device->lock_queue(device, (int)device->queue_graphics.index, 0);
  check_vk(vkQueueSubmit2(queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit2");
  /* The semaphores order everything, which suffices in an engine. The wait is for older validation
   * layers, which do not track timeline semaphores across submits, but do see that the queue is
   * empty. */
  check_vk(vkQueueWaitIdle(queue), "vkQueueWaitIdle");
  device->unlock_queue(device, (int)device->queue_graphics.index, 0);
}

/* Reports light that crossed the edge: the right half was dark. */
static void report(pl_vulkan device, slot_image* lighting) {
  static uint16_t texels[SIDE * SIDE * 4];
  struct pl_tex_transfer_params download;
  int x, lit = 0;
  memset(&download, 0, sizeof download);
  download.tex = lighting->texture;
  download.ptr = texels;
  if (!pl_tex_download(device->gpu, &download)) die("pl_tex_download", lighting->name);
  for (x = SIDE / 2; x < SIDE; ++x)
    lit += texels[4 * (SIDE / 2 * SIDE + x)] != 0;
  printf("light went %d pixels into the dark\n", lit);
}

int main(int argc, char** argv) {
  const char* unbound[] = {"albedo", "scatter_scale", "scattered_light"};
  slot_image images[SLOTS] = {{"lighting", "rgba16hf", 8, NULL, VK_NULL_HANDLE},
                              {"depth", "r32f", 4, NULL, VK_NULL_HANDLE},
                              {"material", "r8u", 1, NULL, VK_NULL_HANDLE}};
  struct pl_log_params log_params = {NULL, NULL, PL_LOG_WARN};
  VkCommandPoolCreateInfo pool_info;
  VkCommandBufferAllocateInfo allocate;
  VkCommandBufferBeginInfo begin;
  dermis_context_desc context_desc = DERMIS_CONTEXT_DESC_INIT;
  dermis_graph_desc graph_desc = DERMIS_GRAPH_DESC_INIT;
  dermis_profile skin = DERMIS_PROFILE_INIT;
  dermis_slot_format depth = DERMIS_SLOT_FORMAT_INIT;
  dermis_slot slots[16] = {DERMIS_SLOT_INIT};
  dermis_image_binding bindings[SLOTS];
  dermis_frame frame = DERMIS_FRAME_INIT;
  dermis_context context;
  dermis_graph graph;
  VkCommandPool pool;
  VkCommandBuffer commands;
  pl_log log;
  pl_vk_inst instance;
  pl_vulkan device;
  char *graph_text, *skin_text;
  uint32_t i, s, slot_count = 16;
  if (argc != 3) die("usage", "libplacebo_host GRAPH.json PROFILE.json");
  log_params.log_cb = pl_log_simple;
  log = pl_log_create(PL_API_VER, &log_params);
  device = make_device(log, &instance);

  /* Creates a context on a device that Dermis did not create. */
  context_desc.instance = device->instance;
  context_desc.physical_device = device->phys_device;
  context_desc.device = device->device;
  context_desc.queue_family = device->queue_graphics.index;
  context_desc.get_instance_proc_addr = instance->get_proc_addr;
  check(dermis_context_create(&context_desc, &context), "dermis_context_create");
  skin.id = 1;
  skin.source.name = argv[2];
  skin.source.text = skin_text = read_file(argv[2], &skin.source.length);
  depth.name = "depth";
  depth.format = VK_FORMAT_R32_SFLOAT;
  graph_desc.source.name = argv[1];
  graph_desc.source.text = graph_text = read_file(argv[1], &graph_desc.source.length);
  graph_desc.width = graph_desc.height = SIDE;
  graph_desc.profiles = &skin;
  graph_desc.formats = &depth;
  graph_desc.profile_count = graph_desc.format_count = 1;
  graph_desc.unbound = unbound;
  graph_desc.unbound_count = 3;
  check(dermis_graph_create(context, &graph_desc, &graph, NULL), "dermis_graph_create");
  check(dermis_graph_slots(graph, &slot_count, slots), "dermis_graph_slots");

  memset(&pool_info, 0, sizeof pool_info);
  pool_info.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool_info.queueFamilyIndex = device->queue_graphics.index;
  check_vk(vkCreateCommandPool(device->device, &pool_info, NULL, &pool), "vkCreateCommandPool");
  memset(&allocate, 0, sizeof allocate);
  allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
  allocate.commandPool = pool;
  allocate.commandBufferCount = 1;
  check_vk(vkAllocateCommandBuffers(device->device, &allocate, &commands), "vkAllocateCommandBuffers");
  memset(&begin, 0, sizeof begin);
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  check_vk(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");

  /* libplacebo renders (here: uploads), and holds each image in the graph's preferred layout. */
  for (i = 0; i < SLOTS; ++i) {
    dermis_image_binding binding = DERMIS_IMAGE_BINDING_INIT;
    pl_vulkan_sem held;
    make_image(device, &images[i]);
    binding.image = pl_vulkan_unwrap(device->gpu, images[i].texture, &binding.format, NULL);
    for (s = 0; s < slot_count; ++s)
      if (strcmp(slots[s].name, images[i].name) == 0) {
        binding.slot = slots[s].id;
        binding.before.layout = slots[s].best_layout;
      }
    held.sem = images[i].semaphore;
    held.value = 1;
    if (!pl_vulkan_hold(device->gpu, images[i].texture, binding.before.layout, held))
      die("pl_vulkan_hold", images[i].name);
    binding.view = make_view(device, binding.image, binding.format);
    binding.width = binding.height = SIDE;
    /* The semaphore makes all earlier work visible, so only the order of our own commands must be
     * stated. */
    binding.before.stages = binding.after.stages = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    binding.after.layout = VK_IMAGE_LAYOUT_GENERAL;
    binding.after.access = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    bindings[i] = binding;
  }
  frame.command_buffer = commands;
  frame.bindings = bindings;
  frame.binding_count = SLOTS;
  frame.frame_index = 1;
  frame.depth_kind = DERMIS_DEPTH_VIEW_UNITS;
  frame.clip_from_view[0] = 62.5f; /* orthographic: 32 mm wide, 0.5 mm per pixel */
  frame.clip_from_view[5] = -62.5f;
  frame.clip_from_view[10] = -1.0f;
  frame.clip_from_view[15] = 1.0f;
  check(dermis_view_record(dermis_graph_view(graph), &frame), "dermis_view_record");
  check_vk(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
  submit(device, commands, images);

  /* libplacebo continues with the result of Dermis. */
  for (i = 0; i < SLOTS; ++i) {
    pl_vulkan_sem free_again;
    free_again.sem = images[i].semaphore;
    free_again.value = 2;
    pl_vulkan_release(device->gpu, images[i].texture, bindings[i].after.layout, free_again);
  }
  report(device, &images[0]);

  pl_gpu_finish(device->gpu);
  vkDeviceWaitIdle(device->device);
  dermis_graph_destroy(graph);
  dermis_context_destroy(context);
  for (i = 0; i < SLOTS; ++i) {
    vkDestroyImageView(device->device, bindings[i].view, NULL);
    pl_tex_destroy(device->gpu, &images[i].texture);
  }
  pl_gpu_finish(device->gpu);
  for (i = 0; i < SLOTS; ++i)
    vkDestroySemaphore(device->device, images[i].semaphore, NULL);
  vkDestroyCommandPool(device->device, pool, NULL);
  free(graph_text);
  free(skin_text);
  pl_vulkan_destroy(&device);
  pl_vk_inst_destroy(&instance);
  pl_log_destroy(&log);
  return 0;
}
