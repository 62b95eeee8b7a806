#version 460
// The last step up: scattered light of every listed pixel.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_gather.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "half.glsl"
#include "radius.glsl"
#include "sap.glsl"
bool near_written(ivec2 at) { return classes_data[sap_tile(at)] != class_none; }
#include "sap_up.glsl"

const float least_share = 0.002; // below it the tent is not worth its time

void main() {
  ivec2 pixel;
  bool copy_only;
  bool listed = listed_pixel(pixel, copy_only);
  if (!copy_only)
    sap_share(pixel - local_texel(), 0, true, true);
  if (!listed)
    return;
  ivec2 texel = texel_of(pixel);
  vec3 light = copy_only ? texelFetch(light_image, texel, 0).rgb : sap_own_light();
  float confidence = 1.0;
  if (!copy_only && sap_own().id != 0u) {
    sap_texel own = sap_own();
    vec3 d_px = sap_d_px(own);
    vec3 centre = sap_lookup(own.id, settings.variant, 0, d_px), tent = sap_lookup(own.id, settings.variant, 1, d_px);
    sap_sum near = sap_sum(light, vec3(own.mass));
    if (max(tent.r, max(tent.g, tent.b)) >= least_share)
      near = sap_tent(0, own);
    sap_sum rest = sap_from_coarser(pixel, 0, own, light, confidence);
    rest.mass *= 1.0 - centre - tent;
    uint widest = profiles[min(own.id, 255u)].widest;
    confidence = mix(confidence, 1.0, centre[widest] + tent[widest]) - tent[widest] * (1.0 - near.mass.r);
    vec3 direct = profile_direct(own.id); // what never scatters needs no surface around
    vec3 mean = sap_blend((centre - direct) * own.mass, light, tent * near.mass, near.light, rest).light;
    light = mix(mean, light, direct);
  }
  imageStore(scattered_image, texel, round_to_half(vec4(light, confidence)));
}
