/* Writes an engine's images as a captured frame (docs/capture.md), so that `dermis validate DIR
 * --diagnose`, `dermis apply` and `dermis reference` can read them. Errors end the program.
 * C99 and C++. */
#ifndef DERMIS_EXAMPLE_WRITE_CAPTURE_H
#define DERMIS_EXAMPLE_WRITE_CAPTURE_H

#include "headless.h"

#include <math.h>
#include <stdint.h>

/* ---- OpenEXR: one part, scanlines, 32-bit floats, no compression, little endian -------------- */

static void capture_int(FILE* file, uint32_t value) {
  const uint8_t bytes[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                            (uint8_t)(value >> 24)};
  fwrite(bytes, 1, 4, file);
}

static void capture_float(FILE* file, float value) {
  uint32_t bits;
  memcpy(&bits, &value, sizeof bits);
  capture_int(file, bits);
}

static void capture_attribute(FILE* file, const char* name, const char* type, uint32_t bytes) {
  fwrite(name, 1, strlen(name) + 1, file);
  fwrite(type, 1, strlen(type) + 1, file);
  capture_int(file, bytes);
}

/* Writes an EXR file. `channels` are one-letter names in alphabetical order, "BGR" or "Y". `values`
 * are interleaved in that order, first row on top. */
static void capture_write_exr(const char* path, uint32_t width, uint32_t height,
                              const char* channels, const float* values) {
  const uint32_t count = (uint32_t)strlen(channels);
  const uint32_t line_bytes = width * count * 4;
  static const char* const windows[] = {"dataWindow", "displayWindow"};
  uint32_t i, x, y, c;
  long first_line;
  FILE* file = fopen(path, "wb");
  if (file == NULL) headless_die("cannot write", path);
  capture_int(file, 20000630); /* magic number */
  capture_int(file, 2);        /* version */
  capture_attribute(file, "channels", "chlist", count * 18 + 1);
  for (c = 0; c < count; ++c) {
    fputc(channels[c], file);
    fputc(0, file);
    capture_int(file, 2); /* float */
    capture_int(file, 0);
    capture_int(file, 1); /* sampling */
    capture_int(file, 1);
  }
  fputc(0, file);
  capture_attribute(file, "compression", "compression", 1);
  fputc(0, file);
  for (i = 0; i < 2; ++i) {
    capture_attribute(file, windows[i], "box2i", 16);
    capture_int(file, 0);
    capture_int(file, 0);
    capture_int(file, width - 1);
    capture_int(file, height - 1);
  }
  capture_attribute(file, "lineOrder", "lineOrder", 1);
  fputc(0, file);
  capture_attribute(file, "pixelAspectRatio", "float", 4);
  capture_float(file, 1.0f);
  capture_attribute(file, "screenWindowCenter", "v2f", 8);
  capture_float(file, 0.0f);
  capture_float(file, 0.0f);
  capture_attribute(file, "screenWindowWidth", "float", 4);
  capture_float(file, 1.0f);
  fputc(0, file); /* end of the header */
  first_line = ftell(file) + (long)height * 8;
  for (y = 0; y < height; ++y) { /* offset of each line */
    capture_int(file, (uint32_t)first_line + y * (line_bytes + 8));
    capture_int(file, 0);
  }
  for (y = 0; y < height; ++y) {
    capture_int(file, y);
    capture_int(file, line_bytes);
    for (c = 0; c < count; ++c)
      for (x = 0; x < width; ++x)
        capture_float(file, values[((size_t)y * width + x) * count + c]);
  }
  if (ferror(file) || fclose(file) != 0) headless_die("cannot write", path);
}

/* ---- images ---------------------------------------------------------------------------------- */

static float capture_half(uint16_t bits) {
  const int exponent = (bits >> 10) & 31, mantissa = bits & 1023;
  const float magnitude = exponent == 0    ? ldexpf((float)mantissa, -24)
                          : exponent == 31 ? (mantissa != 0 ? NAN : INFINITY)
                                           : ldexpf((float)(mantissa + 1024), exponent - 25);
  return (bits & 0x8000) != 0 ? -magnitude : magnitude;
}

/* Returns channel `c` of a texel. Add the formats of your engine here. */
static float capture_channel(VkFormat format, const uint8_t* texel, uint32_t c) {
  float single;
  uint16_t half;
  switch (format) {
  case VK_FORMAT_R8_UINT:
    return (float)texel[c];
  case VK_FORMAT_R8G8B8A8_UNORM:
    return (float)texel[c] / 255.0f;
  case VK_FORMAT_R16G16B16A16_SFLOAT:
    memcpy(&half, texel + 2 * c, sizeof half);
    return capture_half(half);
  case VK_FORMAT_R32_SFLOAT:
  case VK_FORMAT_D32_SFLOAT:
  case VK_FORMAT_R32G32B32A32_SFLOAT:
    memcpy(&single, texel + 4 * c, sizeof single);
    return single;
  default:
    headless_die("capture_channel", "add this format");
    return 0.0f;
  }
}

static uint32_t capture_texel_bytes(VkFormat format) {
  switch (format) {
  case VK_FORMAT_R8_UINT:
    return 1;
  case VK_FORMAT_R32_SFLOAT:
  case VK_FORMAT_D32_SFLOAT:
  case VK_FORMAT_R8G8B8A8_UNORM:
    return 4;
  case VK_FORMAT_R16G16B16A16_SFLOAT:
    return 8;
  default:
    return 16;
  }
}

/* Copies a 2-D image in layout GENERAL, created with TRANSFER_SRC, to host memory and writes it to
 * `path`. Submits and waits; records `host->commands` again. `decode` (may be NULL) maps each
 * value, for example depth values to metres. `channels`: "BGR", or "Y" for the first channel. */
static void capture_image(headless* host, VkImage image, VkFormat format, uint32_t width,
                          uint32_t height, const char* channels, float (*decode)(float),
                          const char* path) {
  HEADLESS_STRUCT(VkBufferCreateInfo, buffer_info, BUFFER_CREATE_INFO);
  HEADLESS_STRUCT(VkMemoryAllocateInfo, memory_info, MEMORY_ALLOCATE_INFO);
  HEADLESS_STRUCT(VkMemoryBarrier2, written, MEMORY_BARRIER_2);
  HEADLESS_STRUCT(VkDependencyInfo, dependency, DEPENDENCY_INFO);
  HEADLESS_STRUCT(VkCommandBufferBeginInfo, begin, COMMAND_BUFFER_BEGIN_INFO);
  const VkMemoryPropertyFlags mapped =
      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  const uint32_t texel_bytes = capture_texel_bytes(format), count = (uint32_t)strlen(channels);
  const size_t pixels = (size_t)width * height;
  float* values = (float*)malloc(pixels * count * sizeof(float));
  VkBufferImageCopy copy;
  VkMemoryRequirements needs;
  VkDeviceMemory memory;
  VkBuffer buffer;
  void* bytes;
  size_t i;
  uint32_t c;
  if (values == NULL) headless_die("out of memory", path);
  buffer_info.size = pixels * texel_bytes;
  buffer_info.usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  HEADLESS_CHECK(vkCreateBuffer(host->device, &buffer_info, NULL, &buffer));
  vkGetBufferMemoryRequirements(host->device, buffer, &needs);
  memory_info.allocationSize = needs.size;
  memory_info.memoryTypeIndex = headless_memory_type(host, needs.memoryTypeBits, mapped);
  HEADLESS_CHECK(vkAllocateMemory(host->device, &memory_info, NULL, &memory));
  HEADLESS_CHECK(vkBindBufferMemory(host->device, buffer, memory, 0));

  HEADLESS_CHECK(vkResetCommandPool(host->device, host->pool, 0));
  HEADLESS_CHECK(vkBeginCommandBuffer(host->commands, &begin));
  written.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  written.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  written.dstStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  written.dstAccessMask = VK_ACCESS_2_TRANSFER_READ_BIT;
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &written;
  vkCmdPipelineBarrier2(host->commands, &dependency);
  memset(&copy, 0, sizeof copy);
  copy.imageSubresource.aspectMask =
      format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  copy.imageSubresource.layerCount = 1;
  copy.imageExtent.width = width;
  copy.imageExtent.height = height;
  copy.imageExtent.depth = 1;
  vkCmdCopyImageToBuffer(host->commands, image, VK_IMAGE_LAYOUT_GENERAL, buffer, 1, &copy);
  written.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
  written.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  written.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  written.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  vkCmdPipelineBarrier2(host->commands, &dependency);
  headless_submit_and_wait(host);

  HEADLESS_CHECK(vkMapMemory(host->device, memory, 0, VK_WHOLE_SIZE, 0, &bytes));
  for (i = 0; i < pixels; ++i)
    for (c = 0; c < count; ++c) {
      /* the channels of "BGR" are in reverse order */
      const uint32_t channel = count == 1 ? 0 : count - 1 - c;
      const float value = capture_channel(format, (const uint8_t*)bytes + i * texel_bytes, channel);
      values[i * count + c] = decode != NULL ? decode(value) : value;
    }
  capture_write_exr(path, width, height, channels, values);
  free(values);
  vkDestroyBuffer(host->device, buffer, NULL);
  vkFreeMemory(host->device, memory, NULL);
}

/* ---- frame.json ------------------------------------------------------------------------------ */

/* Writes frame.json. The matrices are those of dermis_frame, except that captures hold
 * `clip_from_view` without jitter. `profile_file` is the profile of id 1: a path relative to
 * frame.json, or the name of a shipped profile. */
static void capture_write_json(const char* path, uint32_t width, uint32_t height, int perspective,
                               const float* clip_from_view, const float* view_from_world,
                               float metres_per_unit, const char* profile_file) {
  const float* const matrices[2] = {clip_from_view, view_from_world};
  static const char* const names[2] = {"clip_from_view", "view_from_world"};
  int i, j;
  FILE* file = fopen(path, "w");
  if (file == NULL) headless_die("cannot write", path);
  fprintf(file,
          "{ \"dermis_capture\": 1, \"width\": %u, \"height\": %u,\n  \"projection\": \"%s\",\n",
          width, height, perspective ? "perspective" : "orthographic");
  for (i = 0; i < 2; ++i) {
    fprintf(file, "  \"%s\": [", names[i]);
    for (j = 0; j < 16; ++j)
      fprintf(file, "%s%.9g", j == 0 ? "" : ", ", (double)matrices[i][j]);
    fprintf(file, "],\n");
  }
  fprintf(file,
          "  \"metres_per_unit\": %.9g,\n  \"profiles\": [ { \"id\": 1, \"file\": \"%s\" } ] }\n",
          (double)metres_per_unit, profile_file);
  if (ferror(file) || fclose(file) != 0) headless_die("cannot write", path);
}

#endif
