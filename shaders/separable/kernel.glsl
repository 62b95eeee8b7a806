// Rows of the separable kernel's table. passes/separable/separable_kernel.hpp describes the table
// and mirrors these functions.
#ifndef DERMIS_SEPARABLE_KERNEL_GLSL
#define DERMIS_SEPARABLE_KERNEL_GLSL

#include "common/environment.glsl"
#include "constants.glsl"

const int side_taps[3] = int[3](5, 8, 12); // for 11, 17, 25 taps
const int max_side_taps = 12;
const float max_offset_pixels = 32768.0; // of a tap's offset
// separable_offsets(); offsets between nodes and kernels of other pixels of a tile reach further.
const float reach_of_d[3] = float[3](5.0, 7.0, 10.0);
const float longer_reach = 1.05;
const int more_reach = 3; // px
const int rows_per_node[3] = int[3](10, 13, 18);
const int first_row[3] = int[3](0, separable_nodes* rows_per_node[0],
                                separable_nodes*(rows_per_node[0] + rows_per_node[1]));

// Returns the maximum number of pixels to a side that a pass reads. separable_reach_px mirrors it.
int separable_reach(int choice, float d_px) {
  float reach = max(float(side_taps[choice]), longer_reach * reach_of_d[choice] * d_px);
  return int(min(ceil(reach), max_offset_pixels)) + more_reach;
}

// The place of a pixel's kernel in the table.
struct kernel_place {
  int low;       // row 0 of the node below
  int step;      // rows to the node above
  int side;      // taps on one side
  float part;    // 0 at the node below, 1 at the node above
  float stretch; // factor on offsets beyond the last node
};

// `first`: first row of the profile's kernel. `choice`: index of the number of taps.
kernel_place find_kernel(uint first, int choice, float d_px) {
  float position = (log2(d_px) - separable_first_log2_d) / separable_log2_d_step;
  float clamped = clamp(position, 0.0, float(separable_nodes - 1));
  int node = min(int(clamped), separable_nodes - 2);
  kernel_place place;
  place.step = rows_per_node[choice];
  place.side = side_taps[choice];
  place.low = int(first) + first_row[choice] + node * place.step;
  place.part = clamped - float(node);
  place.stretch = exp2(max(0.0, position - float(separable_nodes - 1)) * separable_log2_d_step);
  return place;
}

vec4 kernel_row(kernel_place place, int row) {
  return mix(separable_rows[place.low + row], separable_rows[place.low + place.step + row],
             place.part);
}

// A tap of both sides.
struct kernel_tap {
  vec3 weight;  // on a surface that faces the viewer
  float offset; // px
  // See nearness(): square of the offset in mm, decay per mm, log2 of the factor at distance 0.
  float square, decay, gain;
};

// `core` in mm, `footprint` in mm per px.
kernel_tap find_tap(kernel_place place, int i, float core, float footprint) {
  vec4 row = kernel_row(place, i);
  int decays = place.low + place.side + 3 + ((i - 1) >> 2), at = (i - 1) & 3;
  kernel_tap tap;
  tap.weight = row.rgb;
  tap.offset = clamp(row.w * place.stretch, 1e-6, max_offset_pixels);
  float mm = tap.offset * footprint;
  tap.square = mm * mm;
  tap.decay = mix(separable_rows[decays][at], separable_rows[decays + place.step][at], place.part) /
              (place.stretch * footprint);
  tap.gain = tap.decay * mm + log2(mm + core);
  return tap;
}

// Values that all taps of a pixel share.
struct kernel_ends {
  vec3 own;    // weight of the pixel itself
  vec3 centre; // fraction of the delta
  float core;  // mm
  int used;    // taps of a side whose weights are not negligible
  int dense;   // taps of a side whose offsets are 1, 2, 3 ... px
};

kernel_ends find_ends(kernel_place place, float footprint) {
  vec4 low = separable_rows[place.low + place.side + 2];
  vec4 high = separable_rows[place.low + place.step + place.side + 2];
  kernel_ends ends;
  ends.own = kernel_row(place, 0).rgb;
  ends.centre = kernel_row(place, place.side + 1).rgb;
  ends.core = low.z * footprint;
  ends.used = int(max(low.y, high.y));
  ends.dense = place.stretch > 1.0 ? 0 : int(min(low.x, high.x));
  return ends;
}

// Returns the factor on the weight of a tap whose surface is `rise` mm deeper than the pixel's:
// about the profile at the distance in space divided by the profile at the distance across the
// view. The factor is 1 without a rise and 0 for an infinite rise.
float nearness(kernel_tap tap, float core, float rise) {
  float distance = sqrt(tap.square + rise * rise);
  return exp2(tap.gain - tap.decay * distance) / (distance + core);
}

#endif
