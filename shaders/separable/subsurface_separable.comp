#version 460
// One pass along an axis of the kernel centre * delta + (1 - centre) * a(x) a(y).
// passes/separable/separable_kernel.hpp or jimenez_kernel.hpp fits and tabulates the kernel. Taps
// of another profile are left out and the others renormalised. A tap at another depth is weighted
// by the profile at its 3D distance, divided by the profile at its distance across the view.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "separable/subsurface_separable.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/radius.glsl"
#include "constants.glsl"
#include "common/half.glsl"
#include "common/profile.glsl"

const int side_taps[3] = int[3](5, 8, 12); // for 11, 17, 25 taps
const int rows_per_node[3] = int[3](5 + 2, 8 + 2, 12 + 2);
const int first_row[3] = int[3](0, separable_nodes* rows_per_node[0],
                                separable_nodes*(rows_per_node[0] + rows_per_node[1]));

struct kernel_place {
  int low;       // row 0 of the node below
  int step;      // rows to the node above
  float part;    // 0 at the node below, 1 at the node above
  float stretch; // factor on offsets beyond the last node
};

kernel_place find_kernel(uint separable_row_start, int choice, float d_px) {
  float position = (log2(d_px) - separable_first_log2_d) / separable_log2_d_step;
  float clamped = clamp(position, 0.0, float(separable_nodes - 1));
  int node = min(int(clamped), separable_nodes - 2);
  kernel_place place;
  place.step = rows_per_node[choice];
  place.low = int(separable_row_start) + first_row[choice] + node * place.step;
  place.part = clamped - float(node);
  place.stretch = exp2(max(0.0, position - float(separable_nodes - 1)) * separable_log2_d_step);
  return place;
}

vec4 separable_row(kernel_place place, int row) {
  vec4 value = mix(separable_rows[place.low + row], separable_rows[place.low + place.step + row],
                   place.part);
  value.w *= place.stretch;
  return value;
}

vec3 axis_pass(ivec2 pixel, uint id, float depth, scatter_profile profile, uint row, vec3 own) {
  bool vertical = settings.axis == AXIS_VERTICAL;
  ivec2 axis = vertical ? ivec2(0, 1) : ivec2(1, 0);
  vec2 footprints = pixel_footprint(depth);
  float footprint = vertical ? footprints.y : footprints.x;
  kernel_place place = find_kernel(row, settings.taps, profile.d.w / footprint);

  vec3 weight = separable_row(place, 0).rgb;
  vec3 sum = weight * own, total = weight;
  for (int i = 1; i <= side_taps[settings.taps]; ++i) {
    vec4 tap = separable_row(place, i);
    float below = floor(tap.w);
    float part = tap.w - below;
    for (int k = 0; k < 4; ++k) { // two sides, two texels of the linear interpolation
      float fraction = (k & 1) == 0 ? 1.0 - part : part;
      if (fraction <= 0.0)
        continue;
      float distance_px = below + float(k & 1);
      int offset = int(min(distance_px, 32768.0)) * (k < 2 ? -1 : 1);
      ivec2 q = pixel + axis * offset;
      if (!inside_rect(q))
        continue;
      ivec2 texel = texel_of(q);
      if (texelFetch(material_image, texel, 0).r != id)
        continue;
      float tap_depth = view_depth(texelFetch(depth_image, texel, 0).r);
      if (tap_depth <= 0.0)
        continue;
      float across = distance_px * footprint;
      float rise = tap_depth - depth;
      vec3 nearness = abs(rise) > 1e-4 * across
                          ? profile_falloff(profile, sqrt(across * across + rise * rise)) /
                                max(profile_falloff(profile, across), vec3(1e-37))
                          : vec3(1.0);
      vec3 w = tap.rgb * fraction * nearness;
      sum += w * (vertical ? texelFetch(blurred_image, texel, 0).rgb
                           : texelFetch(light_image, texel, 0).rgb);
      total += w;
    }
  }
  return vec3(total.r > 0.0 ? sum.r / total.r : own.r, total.g > 0.0 ? sum.g / total.g : own.g,
              total.b > 0.0 ? sum.b / total.b : own.b);
}

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = texelFetch(material_image, texel, 0).r;
  if (id == 0u)
    return;
  vec3 light = texelFetch(light_image, texel, 0).rgb;
  vec3 result = light;
  uint row = profiles[min(id, 255u)].separable_row;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  float scale =
      has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  scatter_profile profile = find_profile(id, scale);
  if (!copy_only && depth > 0.0 && row != 0xffffffffu &&
      projected_d(profile.d.w, depth) >= copy_below_d_px) {
    row += uint(settings.kernel * separable_rows_per_kernel);
    bool vertical = settings.axis == AXIS_VERTICAL;
    vec3 own = vertical && has_blurred() ? texelFetch(blurred_image, texel, 0).rgb : light;
    result = axis_pass(pixel, id, depth, profile, row, own);
    if (vertical) {
      vec2 footprints = pixel_footprint(depth);
      kernel_place place = find_kernel(row, settings.taps, profile.d.w / footprints.y);
      vec3 centre = separable_row(place, side_taps[settings.taps] + 1).rgb;
      result = mix(result, light, centre);
    }
  }
  imageStore(scattered_image, texel, vec4(round_to_half(result), 1.0));
}
