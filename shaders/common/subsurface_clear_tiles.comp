#version 460
// Clears an image outside the listed tiles, whose texels a later pass writes. Some drivers take 30
// times as long for vkCmdClearColorImage. A group clears up to 4x4 tiles,
// because a tile alone is little work.
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
#include "common/subsurface_clear_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

const int side = 4; // tiles of a group along each axis

void main() {
  ivec2 first = side * ivec2(gl_WorkGroupID.xy);
  uint entries[side * side];
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 tile = min(first + ivec2(i % side, i / side), frame.tiles - 1);
    entries[i] = listed_data[tile.y * frame.tiles.x + tile.x];
  }
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 pixel = 8 * (first + ivec2(i % side, i / side)) + ivec2(gl_LocalInvocationID.xy);
    if (class_of_tile(entries[i]) == class_none && inside_rect(pixel))
      imageStore(target_image, texel_of(pixel), vec4(0.0));
  }
}
