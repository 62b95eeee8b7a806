#version 460
// One pass along an axis over the tiles that subsurface.select_tiles chose. Light and depth come
// from the host's images. The vertical pass reads unscattered light in other tiles, whose light is
// not blurred. It fades the result to unscattered light by a weight per pixel, which follows the
// tiles' states. At a point of a surface, the weight changes slowly from frame to frame.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "separable/subsurface_separable_selected.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"
#include "common/reproject.glsl"
#include "common/sanitise.glsl"
#include "common/tile_selection.glsl"
#include "common/tiles.glsl"
#include "separable/separable_pass.glsl"
#include "separable/surface.glsl"

const float no_profile = -1.0; // not equal to any stored_profile()

shared uint weight_of_lane[64];

uint word_of_tile(ivec2 tile) {
  ivec2 at = clamp(tile, ivec2(0), frame.tiles - 1);
  return tile_states_data[at.y * frame.tiles.x + at.x];
}
uint state_of_tile(ivec2 tile) { return state_of_word(word_of_tile(tile)); }

// Light before both passes.
vec4 unscattered_at(ivec2 texel) {
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  vec3 light = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
  return vec4(id != 0u ? round_to_half(light) : vec3(0.0), stored_profile(id));
}

vec4 light_at(ivec2 texel) {
  if (settings.axis != AXIS_VERTICAL)
    return unscattered_at(texel);
  // Tiles that enter or leave the list change slowly from unscattered to blurred light.
  uint word = word_of_tile((texel - frame.rect.xy) >> 3);
  bool listed = is_listed(state_of_word(word));
  if (listed && level_of_word(word) == max_selection_level)
    return texelFetch(blurred_image, texel, 0);
  vec4 light = unscattered_at(texel);
  float part = float(level_of_word(word) + 1u) / float(max_selection_level + 1u);
  if (listed)
    light.rgb = mix(light.rgb, texelFetch(blurred_image, texel, 0).rgb, part);
  return light;
}

float depth_at(ivec2 texel) {
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  return depth > 0.0 ? depth : no_surface();
}

// Returns the weight that a pixel approaches: full in tiles that are shown, but falling to 0 across
// a tile towards each tile around that is not.
float final_weight(ivec2 tile, ivec2 pixel) {
  if (state_of_tile(tile) != state_shown)
    return 0.0;
  float least = 1.0;
  vec2 from = vec2(pixel & 7) + 0.5; // distance from the left and upper edge, pixels
  [[unroll]] for (int i = 0; i < 9; ++i) {
    ivec2 side = ivec2(i % 3, i / 3) - 1;
    uint other = state_of_tile(tile + side);
    vec2 distance = vec2(side.x < 0 ? from.x : 8.0 - from.x, side.y < 0 ? from.y : 8.0 - from.y);
    float inside = side.x == 0   ? distance.y
                   : side.y == 0 ? distance.x
                                 : max(distance.x, distance.y);
    bool fades = other == state_unscattered || other == state_fading;
    least = fades ? min(least, smoothstep(0.0, 1.0, inside / fade_px)) : least;
  }
  return float(full_pixel_weight) * least;
}

// Returns the weight of a pixel of the previous rectangle.
uint weight_before(ivec2 pixel) {
  int tile = (pixel.y >> 3) * ((frame.previous_rect.z + 7) >> 3) + (pixel.x >> 3);
  uint state = state_of_word(states_before_data[tile]);
  if (!is_listed(state))
    return state == state_unscattered ? 0u : no_pixel_weight;
  uint word = pixel_weights_before_data[uint(tile) * words_per_tile + weight_word(uvec2(pixel))];
  return word >> (8 * (pixel.x & 3)) & 0xffu;
}

// Returns the weight in the previous frame of the surface at a pixel; negative if unknown.
float followed_weight(ivec2 pixel, float depth) {
  previous_position place =
      has_velocity()
          ? reproject(vec2(pixel), depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
          : reproject(vec2(pixel), depth);
  history_taps taps = taps_around(place);
  float sum = 0.0, total = 0.0;
  [[dont_unroll]] for (int i = 0; i < 4; ++i) {
    float part = taps.weight[i];
    uint weight = part > 0.0 ? weight_before(tap_pixel(taps, i)) : no_pixel_weight;
    part = weight == no_pixel_weight ? 0.0 : part;
    sum += part * float(weight);
    total += part;
  }
  return total < reproject_min_weight ? -1.0 : sum / total;
}

// Returns the weight of a pixel with subsurface.
uint weight_at(ivec2 tile, ivec2 pixel, float depth) {
  float weight = final_weight(tile, pixel);
  if (has_states_before() && has_pixel_weights_before() && history_usable()) {
    float before = followed_weight(pixel, depth);
    if (before >= 0.0)
      weight = clamp(weight, before - float(pixel_weight_step), before + float(pixel_weight_step));
  }
  return uint(weight + 0.5);
}

// Stores the weights of the tile.
void store_weights(ivec2 tile, uint weight) {
  uint lane = gl_LocalInvocationIndex;
  weight_of_lane[lane] = weight;
  barrier();
  if (lane >= words_per_tile || !is_listed(state_of_tile(tile)))
    return;
  uint word = 0u;
  [[unroll]] for (uint i = 0u; i < 4u; ++i)
    word |= weight_of_lane[4u * lane + i] << (8u * i);
  pixel_weights_data[uint(tile.y * frame.tiles.x + tile.x) * words_per_tile + lane] = word;
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
  uint weight = no_pixel_weight;
  ivec2 tile = ivec2(entry, entry >> 15) & 0x7fff;
  if (listed) {
    light = unscattered_at(texel);
    own = light;
    d = profiles[uint(light.a)].d_mm.w;
    if (has_scatter_scale())
      d *= clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r);
    scatters = !copy_only && scatters_at(uint(light.a), d, depth_at(texel));
    if (scatters && vertical)
      own = texelFetch(blurred_image, texel, 0);
    if (vertical && light.a != 0.0)
      weight = weight_at(tile, pixel, depth_at(texel));
  }
  if (vertical && has_pixel_weights() && place < tiles_data[0])
    store_weights(tile, weight);
  separable_pass how = separable_pass(vertical, settings.taps, KERNEL_FITTED);
  vec3 result = scatter(how, pixel, scatters, uint(light.a), d, light, own);
  // The vertical pass reads all texels of the tiles that the horizontal pass blurs.
  if (!listed || (vertical && light.a == 0.0))
    return;
  if (scatters && vertical)
    result = mix(light.rgb, result, float(weight) / float(full_pixel_weight));
  imageStore(scattered_image, texel, vec4(round_to_half(result), vertical ? 1.0 : light.a));
}
