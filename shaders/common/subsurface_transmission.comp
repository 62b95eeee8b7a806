#version 460
// Adds the light transmitted from the far side (slab.glsl) to the light that will scatter. Where
// that contains albedo, it is divided by it before it scatters, so transmitted light is multiplied
// by albedo here.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_transmission.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/radius.glsl"
#include "common/sanitise.glsl"
#include "common/slab.glsl"
#include "common/texturing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside_rect(pixel))
    return;
  ivec2 texel = texel_of(pixel);
  vec4 light = texelFetch(lighting_image, texel, 0);
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  if (id != 0u) {
    float scale = 1.0, metres = texelFetch(thickness_image, texel, 0).r;
    if (has_scatter_scale())
      scale = clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r);
    vec3 back_lighting = texelFetch(back_lighting_image, texel, 0).rgb;
    vec3 transmitted = light_through_slab(id, scale, metres, back_lighting);
    if (settings.texturing == TEXTURING_DEMODULATE && has_albedo())
      transmitted = apply_albedo_after(settings.texturing,
                                       clean_albedo(texelFetch(albedo_image, texel, 0).rgb),
                                       transmitted);
    light.rgb = clean_light(light.rgb) + transmitted;
  }
  imageStore(lit_image, texel, vec4(round_to_half(light.rgb), light.a));
}
