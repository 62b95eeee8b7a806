// One pass of the separable technique along an axis in a tile of 8x8 pixels. The tile and 12 pixels
// to both sides are in shared memory, as is the kernel of one of the tile's pixels. Pixels whose
// kernel differs read their own kernel and taps, as separable/pixel_scatter.glsl does.
#ifndef DERMIS_SEPARABLE_PASS_GLSL
#define DERMIS_SEPARABLE_PASS_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "common/environment.glsl"
#include "separable/kernel.glsl"
#include "separable/pixel_scatter.glsl"
#include "separable/surface.glsl"

// Relative differences in d and in the footprint of pixels that may share a kernel.
const float same_kernel = 0.03;
const int reach = max_side_taps; // of dense taps
const int window_length = 8 + 2 * reach;
const int window_texels = 8 * window_length;

// Light and depth of the window, row by row; infinitely deep where another profile is visible.
shared vec4 window[window_texels];
// The kernel of the tile: weight and offset; square, decay and gain.
shared vec4 shared_weight[max_side_taps + 1];
shared vec4 shared_nearness[max_side_taps + 1];
shared uint chosen; // invocation whose kernel is shared
shared uint chosen_kernel;
shared float chosen_profile, chosen_d_px, chosen_footprint;

// Chooses the kernel of the first pixel that scatters.
void choose_kernel(bool scatters, scattering_pixel at) {
  uint lane = gl_LocalInvocationIndex;
  if (lane == 0u) {
    chosen = 64u;
    chosen_kernel = 0u;
    chosen_profile = -1.0;
    chosen_d_px = 1.0;
    chosen_footprint = 1.0;
  }
  barrier();
  if (scatters)
    atomicMin(chosen, lane);
  barrier();
  if (lane == chosen) {
    chosen_kernel = at.kernel;
    chosen_profile = at.profile;
    chosen_d_px = at.d_px;
    chosen_footprint = at.footprint;
  }
  barrier();
}

void fill_window(separable_pass how, ivec2 tile) {
  int lane = int(gl_LocalInvocationIndex);
  // Each invocation reads a column of texels.
  ivec2 q = tile + (how.vertical ? ivec2(lane & 7, (lane >> 3) - reach)
                                  : ivec2((lane & 31) - reach, lane >> 5));
  int rows = how.vertical ? 8 : 2;
  float profile = chosen_profile;
  [[unroll]] for (int k = 0; k < window_texels / 64; ++k, q.y += rows) {
    ivec2 texel = texel_of(clamp(q, ivec2(0), frame.rect.zw - 1));
    vec4 light = light_at(texel);
    float depth = depth_at(texel);
    bool counts = inside_rect(q) && is_surface(depth) && light.a == profile;
    window[lane + 64 * k] = counts ? vec4(light.rgb, depth) : vec4(vec3(0.0), no_surface());
  }
}

kernel_ends share_kernel(separable_pass how) {
  kernel_place place = find_kernel(chosen_kernel, how.taps, chosen_d_px);
  kernel_ends ends = find_ends(place, chosen_footprint);
  int i = int(gl_LocalInvocationIndex);
  if (i > 0 && i <= place.side) {
    kernel_tap tap = find_tap(place, i, ends.core, chosen_footprint);
    shared_weight[i] = vec4(tap.weight, tap.offset);
    shared_nearness[i] = vec4(tap.square, tap.decay, tap.gain, 0.0);
  }
  return ends;
}

bool shares_kernel(separable_pass how, scattering_pixel at) {
  float profile = chosen_profile, d_px = chosen_d_px, footprint = chosen_footprint;
  return how.kernel == KERNEL_FITTED && at.profile == profile &&
         abs(at.d_px - d_px) <= same_kernel * d_px &&
         abs(at.footprint - footprint) <= same_kernel * footprint;
}

kernel_tap shared_tap(int i) {
  vec4 row = shared_weight[i], near = shared_nearness[i];
  return kernel_tap(row.rgb, row.a, near.x, near.y, near.z);
}

// Scatters with the kernel of the tile.
vec3 scatter_in_window(separable_pass how, scattering_pixel at, kernel_ends ends, vec3 own,
                       vec3 light) {
  float stretch = at.d_px / chosen_d_px;
  ivec2 local = ivec2(gl_LocalInvocationID.xy);
  int stride = how.vertical ? 8 : 1;
  int first = how.vertical ? local.x + 8 * local.y : local.x + window_length * local.y;
  tap_sums sums = tap_sums(ends.own * own, ends.own);
  [[unroll]] for (int i = 1; i <= max_side_taps; ++i) {
    if (i > side_taps[how.taps] || i > min(ends.dense, ends.used))
      break;
    vec4 before = window[first + (reach - i) * stride];
    vec4 after = window[first + (reach + i) * stride];
    before.a -= at.depth;
    after.a -= at.depth;
    add_tap(shared_tap(i), ends.core, before, after, sums);
  }
  for (int i = ends.dense + 1; i <= ends.used; ++i) {
    kernel_tap tap = shared_tap(i);
    add_read_tap(how, at, tap, ends.core, tap.offset * stretch, sums);
  }
  return complete(how, at, ends, own, light, normalised(sums, own));
}

// Returns the light of a pixel after the pass. All invocations of a group must call the function.
// `scatters`: the pixel's light scatters. `d`: in mm. `light`, `own`: of the pixel, before both
// passes and before this pass.
vec3 scatter(separable_pass how, ivec2 pixel, bool scatters, uint profile, float d, vec4 light,
             vec4 own) {
  scattering_pixel at = find_scattering_pixel(how, pixel, scatters, profile, d, light);
  choose_kernel(scatters, at);
  fill_window(how, pixel - ivec2(gl_LocalInvocationID.xy));
  kernel_ends ends = share_kernel(how);
  barrier();
  if (!scatters)
    return own.rgb;
  return shares_kernel(how, at) ? scatter_in_window(how, at, ends, own.rgb, light.rgb)
                                : scatter_alone(how, at, own.rgb, light.rgb);
}

#endif
