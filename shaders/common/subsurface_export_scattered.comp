#version 460
// Exports scattered light for every pixel. Light that does not scatter passes in full precision.
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
  vec3 light = clean_light(texelFetch(lighting_image, texel, 0).rgb);
  uint id = texelFetch(material_image, texel, 0).r;
  if (id != 0u && inside_bounds(pixel)) {
    vec4 d = profiles[min(id, 255u)].d_mm;
    if (has_scatter_scale())
      d *= clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r);
    float depth = view_depth(texelFetch(depth_image, texel, 0).r);
    bool scatters = has_scattered() && depth > 0.0 && projected_d(d.w, depth) >= copy_below_d_px;
    if (has_classes())
      scatters = scatters &&
                 class_of_tile(classes_data[(pixel.y >> 3) * frame.tiles.x + (pixel.x >> 3)]) ==
                     class_scatter;
    vec3 through = texture_light(albedo_image, has_albedo(), settings.texturing, texel, light);
    vec3 scattered = texelFetch(scattered_image, texel, 0).rgb;
    light = scatters
                ? vec3(d.r > 0.0 ? scattered.r : through.r, d.g > 0.0 ? scattered.g : through.g,
                       d.b > 0.0 ? scattered.b : through.b)
                : through;
  }
  imageStore(light_image, texel, vec4(light, 1.0));
}
