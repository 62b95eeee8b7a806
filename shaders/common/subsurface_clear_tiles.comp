#version 460
// Clears an image outside the listed tiles, whose texels a later pass writes. Some drivers take 30
// times as long for vkCmdClearColorImage.
#extension GL_GOOGLE_include_directive : require
#include "common/subsurface_clear_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  uint tile = gl_WorkGroupID.y * uint(frame.tiles.x) + gl_WorkGroupID.x;
  if (!inside_rect(pixel) || class_of_tile(listed_data[tile]) != class_none)
    return;
  imageStore(target_image, texel_of(pixel), vec4(0.0));
}
