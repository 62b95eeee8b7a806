#version 460
// Writes, for tools, why the tile of each pixel was skipped.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_debug_tile_class.bindings.glsl"
#include "common/environment.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside_rect(pixel))
    return;
  ivec2 texel = texel_of(pixel);
  uint tile_class =
      class_of_tile(classes_data[gl_WorkGroupID.y * uint(frame.tiles.x) + gl_WorkGroupID.x]);
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  imageStore(tile_class_image, texel, vec4(float(tile_class), float(id), 0.0, 1.0));
}
