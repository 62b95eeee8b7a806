#version 460
// One pass along an axis over the tiles that subsurface.select_tiles chose. Light and depth come
// from the host's images. The vertical pass leaves out taps in other tiles, whose light is not
// blurred. The result fades to unscattered light by the tiles' weights.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "separable/subsurface_separable_selected.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"
#include "common/sanitise.glsl"
#include "common/tile_selection.glsl"
#include "common/tiles.glsl"
#include "separable/separable_pass.glsl"
#include "separable/surface.glsl"

const float no_profile = -1.0; // not equal to any stored_profile()

uint weight_of(ivec2 tile) {
  ivec2 at = clamp(tile, ivec2(0), frame.tiles - 1);
  return tile_weights_data[at.y * frame.tiles.x + at.x];
}

// Light before both passes.
vec4 unscattered_at(ivec2 texel) {
  uint id = texelFetch(material_image, texel, 0).r;
  vec3 light = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
  return vec4(id != 0u ? round_to_half(light) : vec3(0.0), stored_profile(id));
}

vec4 light_at(ivec2 texel) {
  if (settings.axis != AXIS_VERTICAL)
    return unscattered_at(texel);
  vec4 light = texelFetch(blurred_image, texel, 0);
  light.a = is_chosen(weight_of((texel - frame.rect.xy) >> 3)) ? light.a : no_profile;
  return light;
}

float depth_at(ivec2 texel) {
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  return depth > 0.0 ? depth : no_surface();
}

// Returns the fraction of scattered light at a pixel: the weight of its tile, which falls across the
// tile to the weight of each tile around.
float fraction_at(ivec2 tile, ivec2 pixel) {
  uint own = weight_of(tile);
  float least = float(own);
  vec2 from = vec2(pixel & 7) + 0.5; // distance from the left and upper edge, pixels
  [[unroll]] for (int i = 0; i < 9; ++i) {
    ivec2 side = ivec2(i % 3, i / 3) - 1;
    uint other = min(weight_of(tile + side), own);
    vec2 distance = vec2(side.x < 0 ? from.x : 8.0 - from.x, side.y < 0 ? from.y : 8.0 - from.y);
    float inside = side.x == 0   ? distance.y
                   : side.y == 0 ? distance.x
                                 : max(distance.x, distance.y);
    least = min(least, mix(float(other), float(own), smoothstep(0.0, 1.0, inside / fade_px)));
  }
  return least / float(full_tile_weight);
}

void main() {
  ivec2 pixel = ivec2(0);
  bool copy_only = false;
  uint place = listed_tile(), entry = place < tiles_data[0] ? tiles_data[1u + place] : 0u;
  bool listed = place < tiles_data[0] && pixel_of_tile(entry, pixel, copy_only);
  ivec2 texel = texel_of(pixel);
  bool vertical = settings.axis == AXIS_VERTICAL, scatters = false;
  vec4 light = vec4(0.0), own = vec4(0.0);
  float d = 0.0;
  if (listed) {
    light = unscattered_at(texel);
    own = light;
    d = profiles[uint(light.a)].d_mm.w;
    if (has_scatter_scale())
      d *= clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r);
    scatters = !copy_only && scatters_at(uint(light.a), d, depth_at(texel));
    if (scatters && vertical)
      own = texelFetch(blurred_image, texel, 0);
  }
  separable_pass how = separable_pass(vertical, settings.taps, KERNEL_FITTED);
  vec3 result = scatter(how, pixel, scatters, uint(light.a), d, light, own);
  if (!listed || light.a == 0.0)
    return;
  if (scatters && vertical)
    result = mix(light.rgb, result, fraction_at(ivec2(entry, entry >> 15) & 0x7fff, pixel));
  imageStore(scattered_image, texel, vec4(round_to_half(result), vertical ? 1.0 : light.a));
}
