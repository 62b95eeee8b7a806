/* The minimum of an engine before it embeds Dermis: a device, a command buffer, cleared images.
 * Errors end the program. C99 and C++. */
#ifndef DERMIS_EXAMPLE_HEADLESS_H
#define DERMIS_EXAMPLE_HEADLESS_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <vulkan/vulkan.h>

enum { HEADLESS_MAX_IMAGES = 32 };

typedef struct headless_texture {
  VkImage image;
  VkImageView view;
  VkDeviceMemory memory;
} headless_texture;

typedef struct headless {
  VkInstance instance;
  VkPhysicalDevice gpu;
  VkDevice device;
  VkQueue queue; /* queue of family 0 */
  VkCommandPool pool;
  VkCommandBuffer commands;
  headless_texture textures[HEADLESS_MAX_IMAGES];
  uint32_t texture_count;
} headless;

static void headless_die(const char* what, const char* which) {
  const int more = which != NULL && which[0] != 0;
  fprintf(stderr, "%s%s%s\n", what, more ? ": " : "", more ? which : "");
  exit(1);
}

#define HEADLESS_CHECK(call)                                                                       \
  do {                                                                                             \
    if ((call) != VK_SUCCESS) headless_die("failed", #call);                                       \
  } while (0)
/* Declares a Vulkan struct that is zero except for its type. No shorter form works in both C and
 * C++. */
#define HEADLESS_STRUCT(type, name, s_type)                                                        \
  type name;                                                                                       \
  memset(&name, 0, sizeof name);                                                                   \
  name.sType = VK_STRUCTURE_TYPE_##s_type

/* Creates a device with the features that dermis_query_requirements lists. */
static headless headless_create(void) {
  headless host;
  uint32_t count = 1;
  const float priority = 1.0f;
  HEADLESS_STRUCT(VkApplicationInfo, app, APPLICATION_INFO);
  HEADLESS_STRUCT(VkInstanceCreateInfo, instance, INSTANCE_CREATE_INFO);
  HEADLESS_STRUCT(VkDeviceQueueCreateInfo, queue, DEVICE_QUEUE_CREATE_INFO);
  HEADLESS_STRUCT(VkPhysicalDeviceVulkan13Features, vulkan13, PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  HEADLESS_STRUCT(VkPhysicalDeviceFeatures2, features, PHYSICAL_DEVICE_FEATURES_2);
  HEADLESS_STRUCT(VkDeviceCreateInfo, device, DEVICE_CREATE_INFO);
  HEADLESS_STRUCT(VkCommandPoolCreateInfo, pool_info, COMMAND_POOL_CREATE_INFO);
  HEADLESS_STRUCT(VkCommandBufferAllocateInfo, allocate, COMMAND_BUFFER_ALLOCATE_INFO);
  HEADLESS_STRUCT(VkCommandBufferBeginInfo, begin, COMMAND_BUFFER_BEGIN_INFO);
  memset(&host, 0, sizeof host);
  app.apiVersion = VK_API_VERSION_1_3;
  instance.pApplicationInfo = &app;
  HEADLESS_CHECK(vkCreateInstance(&instance, NULL, &host.instance));
  vkEnumeratePhysicalDevices(host.instance, &count, &host.gpu);
  if (count == 0) headless_die("no Vulkan device", "");
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  vulkan13.synchronization2 = VK_TRUE;
  vulkan13.maintenance4 = VK_TRUE;
  features.features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
  features.pNext = &vulkan13;
  device.pNext = &features;
  device.queueCreateInfoCount = 1;
  device.pQueueCreateInfos = &queue;
  HEADLESS_CHECK(vkCreateDevice(host.gpu, &device, NULL, &host.device));
  vkGetDeviceQueue(host.device, 0, 0, &host.queue);
  HEADLESS_CHECK(vkCreateCommandPool(host.device, &pool_info, NULL, &host.pool));
  allocate.commandPool = host.pool;
  allocate.commandBufferCount = 1;
  HEADLESS_CHECK(vkAllocateCommandBuffers(host.device, &allocate, &host.commands));
  HEADLESS_CHECK(vkBeginCommandBuffer(host.commands, &begin));
  return host;
}

static uint32_t headless_memory_type(const headless* host, uint32_t allowed,
                                     VkMemoryPropertyFlags required) {
  VkPhysicalDeviceMemoryProperties properties;
  uint32_t i;
  vkGetPhysicalDeviceMemoryProperties(host->gpu, &properties);
  for (i = 0; i < properties.memoryTypeCount; ++i)
    if ((allowed & (1u << i)) && (properties.memoryTypes[i].propertyFlags & required) == required)
      return i;
  headless_die("no memory type", "");
  return 0;
}

/* Creates an image in layout GENERAL that the recorded commands clear to `value`. The host owns the
 * image. */
static VkImage headless_image(headless* host, VkFormat format, uint32_t width, uint32_t height,
                              VkImageUsageFlags usage, VkClearColorValue value, VkImageView* view) {
  HEADLESS_STRUCT(VkImageCreateInfo, image_info, IMAGE_CREATE_INFO);
  HEADLESS_STRUCT(VkMemoryAllocateInfo, memory_info, MEMORY_ALLOCATE_INFO);
  HEADLESS_STRUCT(VkImageViewCreateInfo, view_info, IMAGE_VIEW_CREATE_INFO);
  HEADLESS_STRUCT(VkImageMemoryBarrier2, to_general, IMAGE_MEMORY_BARRIER_2);
  HEADLESS_STRUCT(VkDependencyInfo, dependency, DEPENDENCY_INFO);
  const VkImageSubresourceRange whole = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  VkMemoryRequirements needs;
  headless_texture made;
  if (host->texture_count == HEADLESS_MAX_IMAGES) headless_die("too many images", "");
  image_info.imageType = VK_IMAGE_TYPE_2D;
  image_info.format = format;
  image_info.extent.width = width;
  image_info.extent.height = height;
  image_info.extent.depth = image_info.mipLevels = image_info.arrayLayers = 1;
  image_info.samples = VK_SAMPLE_COUNT_1_BIT;
  image_info.usage = usage | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  HEADLESS_CHECK(vkCreateImage(host->device, &image_info, NULL, &made.image));
  vkGetImageMemoryRequirements(host->device, made.image, &needs);
  memory_info.allocationSize = needs.size;
  memory_info.memoryTypeIndex = headless_memory_type(host, needs.memoryTypeBits, 0);
  HEADLESS_CHECK(vkAllocateMemory(host->device, &memory_info, NULL, &made.memory));
  HEADLESS_CHECK(vkBindImageMemory(host->device, made.image, made.memory, 0));
  view_info.image = to_general.image = made.image;
  view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view_info.format = format;
  view_info.subresourceRange = to_general.subresourceRange = whole;
  HEADLESS_CHECK(vkCreateImageView(host->device, &view_info, NULL, &made.view));
  to_general.dstStageMask = VK_PIPELINE_STAGE_2_CLEAR_BIT;
  to_general.dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  to_general.newLayout = VK_IMAGE_LAYOUT_GENERAL;
  to_general.srcQueueFamilyIndex = to_general.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &to_general;
  vkCmdPipelineBarrier2(host->commands, &dependency);
  vkCmdClearColorImage(host->commands, made.image, VK_IMAGE_LAYOUT_GENERAL, &value, 1, &whole);
  host->textures[host->texture_count++] = made;
  *view = made.view;
  return made.image;
}

static inline size_t headless_read_file(const char* path, char* text, size_t capacity) {
  FILE* file = fopen(path, "rb");
  size_t length;
  if (file == NULL) headless_die("cannot read", path);
  length = fread(text, 1, capacity, file);
  fclose(file);
  if (length == capacity) headless_die("the file is too large", path);
  return length;
}

static void headless_submit_and_wait(const headless* host) {
  HEADLESS_STRUCT(VkSubmitInfo, submit, SUBMIT_INFO);
  HEADLESS_CHECK(vkEndCommandBuffer(host->commands));
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &host->commands;
  HEADLESS_CHECK(vkQueueSubmit(host->queue, 1, &submit, VK_NULL_HANDLE));
  HEADLESS_CHECK(vkDeviceWaitIdle(host->device));
}

static void headless_destroy(headless* host) {
  uint32_t i;
  for (i = 0; i < host->texture_count; ++i) {
    vkDestroyImageView(host->device, host->textures[i].view, NULL);
    vkDestroyImage(host->device, host->textures[i].image, NULL);
    vkFreeMemory(host->device, host->textures[i].memory, NULL);
  }
  vkDestroyCommandPool(host->device, host->pool, NULL);
  vkDestroyDevice(host->device, NULL);
  vkDestroyInstance(host->instance, NULL);
}

#endif
