/* Writes the images of one frame as a capture. usage: write_capture FOLDER, which must exist.
 * Then: dermis validate FOLDER --diagnose; dermis apply --graph G --frames FOLDER --out OUT */
#include "write_capture.h"

enum { SIDE = 64 };

static const float near_plane = 0.1f;

/* Returns the metres along the view axis for a depth value of clip_from_view below: reversed,
 * infinite. */
static float metres_from_depth(float value) {
  return value > 0.0f ? near_plane / value : 0.0f;
}

static const char* in_folder(char* path, const char* folder, const char* file) {
  if (strlen(folder) + strlen(file) + 2 > 4096) headless_die("path too long", folder);
  sprintf(path, "%s/%s", folder, file);
  return path;
}

int main(int argc, char** argv) {
  const VkImageUsageFlags none = VK_IMAGE_USAGE_SAMPLED_BIT;
  float clip_from_view[16] = {0}, view_from_world[16] = {0};
  char path[4096];
  VkClearColorValue value;
  VkImageView view;
  VkImage lighting, depth, material;
  headless host = headless_create();
  if (argc != 2) headless_die("usage", "write_capture FOLDER");

  /* The engine's frame: a lit wall of skin 0.5 m away. */
  memset(&value, 0, sizeof value);
  value.float32[0] = 1.0f;
  value.float32[1] = 0.5f;
  value.float32[2] = 0.25f;
  lighting = headless_image(&host, VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE, none, value, &view);
  value.float32[0] = near_plane / 0.5f;
  depth = headless_image(&host, VK_FORMAT_R32_SFLOAT, SIDE, SIDE, none, value, &view);
  value.uint32[0] = 1;
  material = headless_image(&host, VK_FORMAT_R8_UINT, SIDE, SIDE, none, value, &view);
  headless_submit_and_wait(&host);
  clip_from_view[0] = 2.0f;
  clip_from_view[5] = -2.0f;
  clip_from_view[11] = near_plane;
  clip_from_view[14] = -1.0f;
  view_from_world[0] = view_from_world[5] = view_from_world[10] = view_from_world[15] = 1.0f;

  capture_image(&host, lighting, VK_FORMAT_R16G16B16A16_SFLOAT, SIDE, SIDE, "BGR", NULL,
                in_folder(path, argv[1], "lighting.exr"));
  capture_image(&host, depth, VK_FORMAT_R32_SFLOAT, SIDE, SIDE, "Y", metres_from_depth,
                in_folder(path, argv[1], "depth.exr"));
  capture_image(&host, material, VK_FORMAT_R8_UINT, SIDE, SIDE, "Y", NULL,
                in_folder(path, argv[1], "profile.exr"));
  capture_write_json(in_folder(path, argv[1], "frame.json"), SIDE, SIDE, 1, clip_from_view, view_from_world,
                     1.0f, "skin");
  headless_destroy(&host);
  return 0;
}
