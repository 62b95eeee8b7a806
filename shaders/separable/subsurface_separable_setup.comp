#version 460
// Writes light and view depth as subsurface.separable reads them. View depth is written everywhere,
// so that a tap of two reads finds out whether its pixel counts.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "separable/subsurface_separable_setup.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"
#include "common/tile_packing.glsl"
#include "separable/surface.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

void main() {
  uvec2 tile = gl_WorkGroupID.xy;
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside_rect(pixel))
    return;
  ivec2 texel = texel_of(pixel);
  bool listed = class_of_tile(classes_data[tile.y * uint(frame.tiles.x) + tile.x]) != class_none;
  float surface = no_surface();
  if (listed) {
    uint id = profile_of(texelFetch(material_image, texel, 0).r);
    vec4 light = vec4(0.0);
    if (id != 0u) {
      light.rgb =
          pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
      light.a = stored_profile(id);
      float depth = view_depth(texelFetch(depth_image, texel, 0).r);
      surface = depth > 0.0 ? depth : no_surface();
    }
    imageStore(light_image, texel, vec4(round_to_half(light.rgb), light.a));
  }
  imageStore(view_depth_image, texel, vec4(surface, 0.0, 0.0, 0.0));
}
