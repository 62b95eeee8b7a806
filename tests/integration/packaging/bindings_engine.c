/* An engine for bindings_run.py with device, command buffer and images, in C. bindings_run.py makes
 * all calls of Dermis. */
#include "headless.h"

#define ENGINE_API __attribute__((visibility("default")))

static headless host;

ENGINE_API void engine_create(void) {
  host = headless_create();
}
ENGINE_API void* engine_instance(void) {
  return host.instance;
}
ENGINE_API void* engine_gpu(void) {
  return host.gpu;
}
ENGINE_API void* engine_device(void) {
  return host.device;
}
ENGINE_API void* engine_commands(void) {
  return host.commands;
}
ENGINE_API void* engine_loader(void) {
  void* address;
  const PFN_vkGetInstanceProcAddr loader = vkGetInstanceProcAddr;
  memcpy(&address, &loader, sizeof address);
  return address;
}
/* Makes an image with `value` in every channel; `whole` selects an integer format. Returns the
 * handles as numbers. */
ENGINE_API void engine_image(int format, uint32_t side, uint32_t usage, float value, int whole, uint64_t handles[2]) {
  VkClearColorValue color;
  VkImageView view;
  VkImage image;
  int channel;
  for (channel = 0; channel < 4; ++channel)
    if (whole)
      color.uint32[channel] = (uint32_t)value;
    else
      color.float32[channel] = value;
  image = headless_image(&host, (VkFormat)format, side, side, usage, color, &view);
  memcpy(&handles[0], &image, sizeof image);
  memcpy(&handles[1], &view, sizeof view);
}
ENGINE_API void engine_submit_and_wait(void) {
  headless_submit_and_wait(&host);
}
ENGINE_API void engine_destroy(void) {
  headless_destroy(&host);
}
