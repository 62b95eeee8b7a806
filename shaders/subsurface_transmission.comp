#version 460
// Light that came through from the far side, added to the light that will scatter. A slab of thickness t that is lit
// evenly from behind lets through what the profile carries further than t: for Burley 1/4 e^(-t/d) + 3/4 e^(-t/3d).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_transmission.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
#include "profile.glsl"
#include "radius.glsl"
#include "sanitise.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

const float mm_per_metre = 1000.0;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside_rect(pixel))
    return;
  ivec2 texel = texel_of(pixel);
  vec4 light = texelFetch(lighting_image, texel, 0);
  uint id = texelFetch(material_image, texel, 0).r;
  if (id != 0u) {
    float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
    scatter_profile profile = find_profile(id, scale);
    float metres = texelFetch(thickness_image, texel, 0).r;
    vec3 behind = clean_light(texelFetch(back_lighting_image, texel, 0).rgb);
    light.rgb = clean_light(light.rgb);
    if (profile.d.w > 0.0 && metres >= 0.0) { // NaN compares false
      vec3 through = profile_survival(profile, max(metres * mm_per_metre, 1e-6));
      light.rgb += behind * through * (1.0 - profile_direct(id));
    }
  }
  imageStore(lit_image, texel, vec4(round_to_half(light.rgb), light.a));
}
