#version 460
// Exports scattered light for every pixel. Light that does not scatter passes in full precision.
// With `leave_scattered`, texels whose light scatters are only marked.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_export_scattered.bindings.glsl"
#include "common/environment.glsl"
#include "common/pixel_light.glsl"
#include "common/radius.glsl"
#include "common/tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside_rect(pixel))
    return;
  ivec2 texel = texel_of(pixel);
  bool left = settings.leave_scattered != 0;
  vec4 light = vec4(clean_light(texelFetch(lighting_image, texel, 0).rgb), 1.0);
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  if (id != 0u && inside_bounds(pixel)) {
    vec4 d = profiles[min(id, 255u)].d_mm;
    if (has_scatter_scale())
      d *= clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r);
    float depth = view_depth(texelFetch(depth_image, texel, 0).r);
    bool scatters = (left || has_scattered()) && depth > 0.0 &&
                    projected_d(d.w, depth) >= copy_below_d_px;
    if (has_classes())
      scatters = scatters &&
                 class_of_tile(classes_data[(pixel.y >> 3) * frame.tiles.x + (pixel.x >> 3)]) ==
                     class_scatter;
    light.rgb = texture_light(albedo_image, has_albedo(), settings.texturing, texel, light.rgb);
    if (scatters && left)
      light.a = 0.0;
    else if (scatters)
      light.rgb = mix(light.rgb, texelFetch(scattered_image, texel, 0).rgb,
                      greaterThan(d.rgb, vec3(0.0)));
  }
  imageStore(light_image, texel, light);
}
