#version 460
// One group for 4x4 tiles, an invocation for two rows of a tile: has a tile subsurface, and does any pixel of it
// scatter further than itself? Each pixel's material is read once; nothing else is where there is none. Counts tiles:
// sums of integers, which no order changes. Tells between which values the light of scattering tiles lies, too, of each
// tile and of the group's all together.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_classify.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/half.glsl"
#include "common/light_range.glsl"
#include "common/pixel_light.glsl"
#include "common/radius.glsl"
#include "common/sanitise.glsl"
#include "common/tile_packing.glsl"

const uint block_tiles = flat_cell_side * flat_cell_side;
const int run = 16; // pixels of an invocation: two rows of a tile
layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

// By tile: 0 nothing, 1 subsurface below a pixel, else the bits of the largest d in pixels; then the least and the greatest
// light as bits. Floats from 0 on are ordered as their bits are.
const uint below_a_pixel = 1u;
shared uint widest_of[block_tiles];
shared uint holes_of[block_tiles]; // whether any pixel has none
shared uvec3 low_of[block_tiles], high_of[block_tiles];

uint class_of(uint widest) {
  return widest > below_a_pixel ? class_scatter : widest == below_a_pixel ? class_copy : class_none;
}

ivec2 run_pixel(ivec2 first, int i) { return first + ivec2(i & 7, i >> 3); }

// A bit for each pixel of the run that lies where subsurface may be.
uint run_inside(ivec2 first) {
  ivec2 from = clamp(frame.bounds.xy - first, ivec2(0), ivec2(8, 2));
  ivec2 to = clamp(min(frame.bounds.xy + frame.bounds.zw, frame.rect.zw) - first, ivec2(0), ivec2(8, 2));
  uint row = ((1u << uint(to.x)) - 1u) & ~((1u << uint(from.x)) - 1u);
  return (from.y == 0 && to.y > 0 ? row : 0u) | (from.y < 2 && to.y == 2 ? row << 8 : 0u);
}

// A bit for each pixel of the run that has subsurface.
uint find_subsurface(ivec2 first, out uint ids[run]) {
  uint mask = run_inside(first);
  ivec2 last = texel_of(frame.rect.zw - 1);
  [[unroll]] for (int i = 0; i < run; ++i) {
    ids[i] = texelFetch(material_image, min(texel_of(run_pixel(first, i)), last), 0).r;
    mask &= ids[i] != 0u ? ~0u : ~(1u << uint(i));
  }
  return mask;
}

uint look_at(ivec2 pixel) {
  ivec2 texel = texel_of(pixel);
  uint id = texelFetch(material_image, texel, 0).r; // once more: an index into what was read would cost every pixel
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  float d_px = depth > 0.0 ? projected_d(profiles[min(id, 255u)].d_mm.w * scale, depth) : 0.0;
  return d_px >= copy_below_d_px ? floatBitsToUint(d_px) : below_a_pixel;
}

// d over the nearest depth is the widest of pixels of one profile. 0: no depth is there.
float find_nearest(ivec2 first, uint mask) {
  float nearest = largest_depth_mm;
  ivec2 last = texel_of(frame.rect.zw - 1);
  [[unroll]] for (int i = 0; i < run; ++i) {
    float depth = view_depth(texelFetch(depth_image, min(texel_of(run_pixel(first, i)), last), 0).r);
    nearest = depth > 0.0 && (mask >> uint(i) & 1u) != 0u ? min(nearest, depth) : nearest;
  }
  return nearest < largest_depth_mm ? nearest : 0.0;
}

// The widest d of the run's pixels, as widest_of.
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

void gather_light(ivec2 first, uint mask, uint tile) {
  vec3 low = vec3(largest_half), high = vec3(0.0);
  bool any = mask != 0u;
  while (mask != 0u) {
    vec3 light = round_to_half(pixel_light(texel_of(run_pixel(first, findLSB(mask)))));
    mask &= mask - 1u;
    low = min(low, light);
    high = max(high, light);
  }
  for (uint left = any ? 3u : 0u; left != 0u; --left) {
    atomicMin(low_of[tile][left - 1u], floatBitsToUint(low[left - 1u]));
    atomicMax(high_of[tile][left - 1u], floatBitsToUint(high[left - 1u]));
  }
}

void main() {
  uint lane = gl_LocalInvocationIndex;
  ivec2 block = ivec2(gl_WorkGroupID.xy) * int(flat_cell_side);
  uint row_pair = lane / flat_cell_side, column = lane % flat_cell_side; // runs beside each other: invocations, too
  ivec2 first = 8 * block + ivec2(8u * column, 2u * row_pair);
  uint tile_of_run = row_pair / flat_cell_side * flat_cell_side + column;
  bool ranged = has_light_range() && has_light_cells() && has_lighting();

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
  if (ranged) {
    gather_light(first, class_of(widest_of[tile_of_run]) == class_scatter ? mask : 0u, tile_of_run);
    barrier();
  }

  ivec2 tile = block + ivec2(lane % flat_cell_side, lane / flat_cell_side);
  if (lane < block_tiles && all(lessThan(tile, frame.tiles))) {
    int index = tile.y * frame.tiles.x + tile.x;
    uint own = widest_of[lane];
    classes_data[index] = class_of(own) | (holes_of[lane] == 0u ? class_full_bit : 0u);
    if (ranged) // light below a pixel stays where it is, and is not looked at: beside it nothing counts as flat
      light_range_data[index] =
          own == below_a_pixel ? any_light()
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
}
