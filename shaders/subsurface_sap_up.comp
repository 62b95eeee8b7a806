#version 460
// One level up: its own light and what the coarser level hands down, blended by the profile's shares.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_up.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
bool near_written(ivec2 at) { return true; }
#include "sap_up.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

const float least_share = 0.004; // below it the tent is not worth its time

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) - 1;
  int level = settings.level;
  bool smooth_level = settings.variant == VARIANT_SMOOTH, last = !has_coarse_scattered();
  sap_share(at - local_texel(), level, smooth_level, !last);
  if (!sap_inside(at, level))
    return;
  sap_texel own = sap_own();
  vec4 light = vec4(0.0);
  vec3 mass = vec3(0.0);
  if (own.id != 0u) {
    vec3 share = last ? vec3(1.0) : sap_lookup(own.id, settings.variant, level + 1, sap_d_px(own));
    sap_sum here = sap_sum(sap_own_light(), vec3(own.mass));
    if (smooth_level && max(share.r, max(share.g, share.b)) >= least_share)
      here = sap_tent(level, own);
    float confidence = 0.0;
    sap_sum rest = sap_sum(here.light, vec3(0.0));
    if (!last)
      rest = sap_from_coarser(at, level, own, here.light, confidence);
    rest.mass *= 1.0 - share;
    sap_sum blend = sap_blend(share * here.mass, here.light, vec3(0.0), here.light, rest);
    float widest = share[profiles[min(own.id, 255u)].widest];
    light = vec4(blend.light, mix(confidence, here.mass.r, widest));
    mass = blend.mass;
  }
  imageStore(scattered_image, sap_address(at, level), round_to_half(light));
  imageStore(mass_image, sap_address(at, level), vec4(round_to_half(mass), 1.0));
}
