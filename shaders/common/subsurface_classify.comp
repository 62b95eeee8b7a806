#version 460
// Classifies 4x4 tiles per group: whether a tile has subsurface, and whether any of its pixels
// scatters further than itself. An invocation covers two rows of a tile.
// Reads each pixel's material once, and nothing else where there is no subsurface. Counts tiles
// with integer sums, which do not depend on the order. Writes the range of the light of scattering
// tiles, by tile and for the group as a whole.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_classify.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/half.glsl"
#include "common/light_range.glsl"
#include "common/list_state.glsl"
#include "common/pixel_light.glsl"
#include "common/radius.glsl"
#include "common/relief.glsl"
#include "common/sanitise.glsl"
#include "common/tile_packing.glsl"

const uint block_tiles = uniform_cell_side * uniform_cell_side;
const int run = 16; // pixels of an invocation: two rows of 8 pixels of a tile
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

// By tile. widest_of: 0 nothing, 1 subsurface that scatters below a pixel, else the bits of the
// largest d in pixels. low_of and high_of: minimum and maximum light as bits, because floats >= 0
// are ordered as their bits.
const uint below_a_pixel = 1u;
shared uint widest_of[block_tiles];
shared uint holes_of[block_tiles]; // whether any pixel has no subsurface
shared uvec3 low_of[block_tiles], high_of[block_tiles];
shared uint relief_sum, relief_pixels; // of the group

uint class_of(uint widest) {
  return widest > below_a_pixel ? class_scatter : widest == below_a_pixel ? class_copy : class_none;
}

ivec2 run_pixel(ivec2 first, int i) { return first + ivec2(i & 7, i >> 3); }

// Returns a bit for each pixel of an invocation, from `first` on, that is inside the rectangle and
// the bounds of subsurface. Bits 0 to 7 are the first row.
uint mask_inside(ivec2 first) {
  ivec2 from = clamp(frame.bounds.xy - first, ivec2(0), ivec2(8, 2));
  ivec2 to =
      clamp(min(frame.bounds.xy + frame.bounds.zw, frame.rect.zw) - first, ivec2(0), ivec2(8, 2));
  uint row = ((1u << uint(to.x)) - 1u) & ~((1u << uint(from.x)) - 1u);
  return (from.y == 0 && to.y > 0 ? row : 0u) | (from.y < 2 && to.y == 2 ? row << 8 : 0u);
}

// Returns a bit for each pixel of the run that has subsurface.
uint find_subsurface(ivec2 first, out uint ids[run]) {
  uint mask = mask_inside(first);
  ivec2 last = texel_of(frame.rect.zw - 1);
  [[unroll]] for (int i = 0; i < run; ++i) {
    ids[i] = profile_of(texelFetch(material_image, min(texel_of(run_pixel(first, i)), last), 0).r);
    mask &= ids[i] != 0u ? ~0u : ~(1u << uint(i));
  }
  return mask;
}

uint look_at(ivec2 pixel) {
  ivec2 texel = texel_of(pixel);
  // Reads the id again, because indexing the array of ids at run time would cost every pixel.
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  float scale =
      has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  float d_px = depth > 0.0 ? projected_d(profiles[min(id, 255u)].d_mm.w * scale, depth) : 0.0;
  return d_px >= copy_below_d_px ? floatBitsToUint(d_px) : below_a_pixel;
}

// Returns the nearest depth of the run; 0 if no pixel has a depth. For pixels of one profile, the
// nearest depth gives the widest d in pixels.
float find_nearest(ivec2 first, uint mask) {
  float nearest = largest_depth_mm;
  ivec2 last = texel_of(frame.rect.zw - 1);
  [[unroll]] for (int i = 0; i < run; ++i) {
    float depth =
        view_depth(texelFetch(depth_image, min(texel_of(run_pixel(first, i)), last), 0).r);
    nearest = depth > 0.0 && (mask >> uint(i) & 1u) != 0u ? min(nearest, depth) : nearest;
  }
  return nearest < largest_depth_mm ? nearest : 0.0;
}

// Returns the widest d of the run's pixels, encoded as in widest_of.
uint find_widest(ivec2 first, uint mask, uint ids[run]) {
  uint widest = 0u, others = 0u, id = 0u;
  [[unroll]] for (int i = 0; i < run; ++i)
    id = max(id, (mask >> uint(i) & 1u) != 0u ? ids[i] : 0u);
  [[unroll]] for (int i = 0; i < run; ++i)
    others |= ids[i] != id ? 1u << uint(i) : 0u;
  bool alike = (mask & others) == 0u && !has_scatter_scale();
  if (alike && mask != 0u) {
    float depth = find_nearest(first, mask);
    float d_px = depth > 0.0 ? projected_d(profiles[min(id, 255u)].d_mm.w, depth) : 0.0;
    widest = d_px >= copy_below_d_px ? floatBitsToUint(d_px) : below_a_pixel;
    mask = 0u;
  }
  while (mask != 0u) {
    ivec2 pixel = run_pixel(first, findLSB(mask));
    mask &= mask - 1u;
    widest = max(widest, look_at(pixel));
  }
  return widest;
}

vec3 own_light(ivec2 texel) {
  return pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
}

void gather_light(ivec2 first, uint mask, uint tile) {
  vec3 low = vec3(largest_half), high = vec3(0.0);
  bool any = mask != 0u;
  while (mask != 0u) {
    ivec2 texel = texel_of(run_pixel(first, findLSB(mask)));
    vec3 light = round_to_half(own_light(texel));
    mask &= mask - 1u;
    low = min(low, light);
    high = max(high, light);
  }
  for (uint left = any ? 3u : 0u; left != 0u; --left) {
    atomicMin(low_of[tile][left - 1u], floatBitsToUint(low[left - 1u]));
    atomicMax(high_of[tile][left - 1u], floatBitsToUint(high[left - 1u]));
  }
}

// Adds the relief of one pixel of a run that has subsurface.
void gather_relief(ivec2 first, uint mask, uint turn) {
  const int middle = 4;
  bool at_middle = (mask >> uint(middle) & 1u) != 0u;
  ivec2 pixel = run_pixel(first, at_middle ? middle : findLSB(mask));
  ivec2 texel = texel_of(pixel);
  float scale =
      has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  float relief = relief_of(material_image, depth_image, pixel, turn, scale);
  if (relief < 0.0)
    return;
  atomicAdd(relief_sum, uint(round(relief_steps * relief)));
  atomicAdd(relief_pixels, 1u);
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  ivec2 block = ivec2(gl_WorkGroupID.xy) * int(uniform_cell_side);
  // adjacent runs map to adjacent invocations
  uint row_pair = lane / uniform_cell_side, column = lane % uniform_cell_side;
  ivec2 first = 8 * block + ivec2(8u * column, 2u * row_pair);
  uint tile_of_run = row_pair / uniform_cell_side * uniform_cell_side + column;
  bool ranged = has_light_range() && has_light_cells() && has_lighting();
  if (has_list_state() && gl_WorkGroupID.xy == uvec2(0) && lane < uint(state_words))
    list_state_data[lane] = 0u;

  if (lane == 0u) {
    relief_sum = 0u;
    relief_pixels = 0u;
  }
  if (lane < block_tiles) {
    widest_of[lane] = 0u;
    holes_of[lane] = 0u;
    low_of[lane] = uvec3(floatBitsToUint(largest_half));
    high_of[lane] = uvec3(0u);
  }
  uint ids[run];
  uint mask = find_subsurface(first, ids);
  bool any_hole = mask != (1u << uint(run)) - 1u;
  uint widest = find_widest(first, mask, ids);
  barrier();
  if (widest != 0u)
    atomicMax(widest_of[tile_of_run], widest);
  if (any_hole)
    atomicOr(holes_of[tile_of_run], 1u);
  barrier();
  bool counts_relief = settings.relief != 0 && counts_relief_in(gl_WorkGroupID.xy);
  uint scattering_mask = class_of(widest_of[tile_of_run]) == class_scatter ? mask : 0u;
  if (ranged)
    gather_light(first, scattering_mask, tile_of_run);
  if (counts_relief && scattering_mask != 0u)
    gather_relief(first, scattering_mask,
                  lane + 5u * gl_WorkGroupID.x + 11u * gl_WorkGroupID.y & 63u);
  if (ranged || counts_relief)
    barrier();

  ivec2 tile = block + ivec2(lane % uniform_cell_side, lane / uniform_cell_side);
  if (lane < block_tiles && all(lessThan(tile, frame.tiles))) {
    int index = tile.y * frame.tiles.x + tile.x;
    uint own = widest_of[lane];
    classes_data[index] = class_of(own) | (holes_of[lane] == 0u ? class_full_bit : 0u);
    // Light that scatters below a pixel is copied and not read here, so no tile next to it counts
    // as uniform.
    if (ranged)
      light_range_data[index] =
          own == below_a_pixel
              ? any_light()
              : pack_range(uintBitsToFloat(low_of[lane]), uintBitsToFloat(high_of[lane]),
                           own == 0u ? 0.0 : uintBitsToFloat(own));
  }
  if (lane != 0u)
    return;
  uint scattering = 0u, copied = 0u, steps = 0u;
  uvec3 low = low_of[0], high = high_of[0];
  [[dont_unroll]] for (uint t = 0u; t < block_tiles; ++t) {
    uint own = widest_of[t];
    scattering += own > below_a_pixel ? 1u : 0u;
    copied += own == below_a_pixel ? 1u : 0u;
    steps += own > below_a_pixel ? counter_steps(uintBitsToFloat(own)) : 0u;
    low = min(low, low_of[t]);
    high = max(high, high_of[t]);
  }
  if (ranged)
    light_cells_data[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] =
        copied > 0u ? any_light() : pack_range(uintBitsToFloat(low), uintBitsToFloat(high), 0.0);
  count_tiles(scattering, copied, steps);
  if (counts_relief && relief_pixels != 0u) {
    atomicAdd(counters.relief_sum, relief_sum);
    atomicAdd(counters.relief_pixels, relief_pixels);
  }
}
