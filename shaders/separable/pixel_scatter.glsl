// One pixel's pass along an axis of the kernel centre * delta + (1 - centre) * a(x) a(y).
// passes/separable/separable_kernel.hpp or jimenez_kernel.hpp fits and tabulates the kernel. Taps
// of another profile are left out and the others renormalised. Filtered reads would mix profiles. A
// tap at another depth is weighted by nearness().
#ifndef DERMIS_PIXEL_SCATTER_GLSL
#define DERMIS_PIXEL_SCATTER_GLSL

#include "common/environment.glsl"
#include "common/radius.glsl"
#include "constants.glsl"
#include "options.glsl"
#include "separable/kernel.glsl"
#include "separable/surface.glsl"

// Pixels are square up to this difference of the root of their sides' ratio from 1.
const float same_elongation = 0.001;

// The kernel that includes this file defines both functions.
// Light that the pass scatters, with the profile in alpha.
vec4 light_at(ivec2 texel);
// View depth in mm; infinite where no subsurface is visible.
float depth_at(ivec2 texel);

// Settings of the pass.
struct separable_pass {
  bool vertical;
  int taps, kernel;
};

// A pixel that scatters.
struct scattering_pixel {
  ivec2 texel;
  int before, after; // pixels to the first and to the last pixel along the axis
  float profile;     // as stored in the light's alpha
  float depth;       // mm
  float footprint;   // mm per pixel along the axis
  float d_px;        // of the widest channel, along the axis
  // Root of the footprints' ratio, along the axis over across it: 1 if pixels are square.
  float elongation;
  uint kernel;       // first row of its kernels
};

// `scatters`: the pixel's light scatters; if not, only the place of the result is valid. `profile`,
// `d` in mm and `light` are those of the pixel.
scattering_pixel find_scattering_pixel(separable_pass how, ivec2 pixel, bool scatters, uint profile,
                                       float d, vec4 light) {
  ivec2 texel = texel_of(pixel);
  ivec2 ends_of_line = how.vertical ? ivec2(pixel.y, frame.rect.w) : ivec2(pixel.x, frame.rect.z);
  scattering_pixel at = scattering_pixel(texel, ends_of_line.x, ends_of_line.y - 1 - ends_of_line.x,
                                         0.0, 0.0, 1.0, 1.0, 1.0, 0u);
  if (scatters) {
    float depth = depth_at(texel);
    vec2 footprints = pixel_footprint(depth);
    at.profile = light.a;
    at.depth = depth;
    at.footprint = how.vertical ? footprints.y : footprints.x;
    at.elongation = sqrt(at.footprint / (how.vertical ? footprints.x : footprints.y));
    at.d_px = d / at.footprint;
    at.kernel = profiles[profile].separable_row + uint(how.kernel * separable_rows_per_kernel);
  }
  return at;
}

ivec2 along_axis(separable_pass how, int pixels) {
  return how.vertical ? ivec2(0, pixels) : ivec2(pixels, 0);
}

// Sums over the taps of both sides.
struct tap_sums {
  vec3 light, weight;
};

// Adds a tap. rgb: light, a: rise in mm.
void add_tap(kernel_tap tap, float core, vec4 before, vec4 after, inout tap_sums sums) {
  float near_before = nearness(tap, core, before.a), near_after = nearness(tap, core, after.a);
  sums.light += tap.weight * (near_before * before.rgb + near_after * after.rgb);
  sums.weight += tap.weight * (near_before + near_after);
}

// Returns light and rise of a pixel on the axis; rise is infinite if it does not contribute.
// `inside`: the pixel is in the rectangle; otherwise `texel` is of another pixel.
vec4 read_tap(scattering_pixel at, ivec2 texel, bool inside) {
  vec4 light = light_at(texel);
  float depth = depth_at(texel);
  bool counts = inside && is_surface(depth) && light.a == at.profile;
  return counts ? vec4(light.rgb, depth - at.depth) : vec4(vec3(0.0), no_surface());
}
vec4 tap_before(separable_pass how, scattering_pixel at, int pixels) {
  return read_tap(at, at.texel - along_axis(how, min(pixels, at.before)), pixels <= at.before);
}
vec4 tap_after(separable_pass how, scattering_pixel at, int pixels) {
  return read_tap(at, at.texel + along_axis(how, min(pixels, at.after)), pixels <= at.after);
}

// Returns whether offsets are whole pixels, as separable_whole_taps says. Other kernels
// interpolate between two pixels: few taps have less error there, and the published kernel has
// several taps within a pixel.
bool reads_nearest(separable_pass how) {
  return how.kernel == KERNEL_FITTED && how.taps == TAPS_25;
}

// Adds a tap at an offset in pixels, read from the images.
void add_read_tap(separable_pass how, scattering_pixel at, kernel_tap tap, float core,
                  float offset, inout tap_sums sums) {
  if (reads_nearest(how)) {
    int pixels = int(roundEven(offset));
    add_tap(tap, core, tap_before(how, at, pixels), tap_after(how, at, pixels), sums);
    return;
  }
  int below = int(offset);
  float part = offset - float(below);
  vec3 weight = tap.weight;
  for (int k = 0; k < 2; ++k) {
    tap.weight = weight * (k == 0 ? 1.0 - part : part);
    add_tap(tap, core, tap_before(how, at, below + k), tap_after(how, at, below + k), sums);
  }
}

vec3 normalised(tap_sums sums, vec3 own) {
  return mix(own, sums.light / max(sums.weight, vec3(1e-30)), greaterThan(sums.weight, vec3(0.0)));
}

// Completes the pass of an axis. The table has kernels of square pixels, whose delta depends on
// the side. Here the delta is that of a square pixel of the same area, and the axis keeps the
// kernel's projection on it. `own`, `light`: of the pixel, before this pass and before both passes.
vec3 complete(separable_pass how, scattering_pixel at, kernel_ends ends, vec3 own, vec3 light,
              vec3 result) {
  vec3 centre = ends.centre;
  if (abs(at.elongation - 1.0) > same_elongation && how.kernel == KERNEL_FITTED) {
    kernel_place place = find_kernel(at.kernel, how.taps, at.d_px * at.elongation);
    vec3 mean_centre = kernel_row(place, place.side + 1).rgb;
    vec3 fraction = (1.0 - centre) / max(1.0 - mean_centre, vec3(1e-6));
    // Above 1, the fraction takes weight from the pixel itself, but not more than it has.
    result = mix(own, result, min(fraction, 1.0 / max(1.0 - ends.own, vec3(1e-6))));
    centre = mean_centre;
  }
  return how.vertical ? mix(result, light, centre) : result;
}

// Scatters along the axis with the pixel's own kernel. `light`: before the horizontal pass.
vec3 scatter_alone(separable_pass how, scattering_pixel at, vec3 own, vec3 light) {
  kernel_place place = find_kernel(at.kernel, how.taps, at.d_px);
  kernel_ends ends = find_ends(place, at.footprint);
  tap_sums sums = tap_sums(ends.own * own, ends.own);
  for (int i = 1; i <= ends.used; ++i) {
    kernel_tap tap = find_tap(place, i, ends.core, at.footprint);
    add_read_tap(how, at, tap, ends.core, tap.offset, sums);
  }
  return complete(how, at, ends, own, light, normalised(sums, own));
}

// Returns whether a pixel at `depth` scatters. `d`: in mm.
bool scatters_at(uint profile, float d, float depth) {
  return profile != 0u && is_surface(depth) && profiles[profile].separable_row != 0xffffffffu &&
         projected_d(d, depth) >= copy_below_d_px;
}

#endif
