#version 460
// Estimates by how much scattering changes each tile, from squares of ranges of exposed light:
// their mean over the tile and those around, plus a fraction of that of all light that scattering
// reaches; times the fraction that a short d leaves, times the square of the host's importance.
// Finds the weights that the tile's surface had in the previous frame: they raise the estimate, and
// decide whether the tile is kept. An invocation handles a tile.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/subsurface_tile_change.bindings.glsl"
#include "common/constants_math.glsl"
#include "common/environment.glsl"
#include "common/sanitise.glsl"
#include "common/light_range.glsl"
#include "common/reproject.glsl"
#include "common/tile_packing.glsl"
#include "common/tile_selection.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

const float max_range = 4.0;            // of exposed light
const float change_steps = 4194304.0;   // 2^22: a step is a range of 2^-11
const float full_change_d_px = 4.0;     // the squared change grows with d up to here
const float tiles_per_d = 0.25;         // two d
const int max_reach = 3;                // tiles to each side
// Fraction that the squared range of all light in reach counts. Values from 0 to 1 were compared on
// bust, pan and dolly at d from 0.5 to 4 px.
const float reached_fraction = 0.25;
const int importance_step = 2;          // pixels between those whose importance is read

// Returns the square of the luminance of a range of light, exposed.
float squared_range(vec3 low, vec3 high) {
  float range =
      min(frame.exposure * dot(max(high - low, vec3(0.0)), luminance_weights), max_range);
  return range * range;
}

// Returns the range of the light of a tile. Returns false if the tile does not scatter: its light
// is not known.
bool range_of(ivec2 tile, out vec3 low, out vec3 high) {
  uvec4 range = light_range_data[tile.y * frame.tiles.x + tile.x];
  unpack_range(range, low, high);
  return range.w != 0u;
}

// Returns the squared range of all light up to `reach` tiles away.
float squared_range_around(ivec2 tile, int reach) {
  vec3 low = vec3(65504.0), high = vec3(0.0);
  ivec2 first = max(tile - reach, ivec2(0)), last = min(tile + reach, frame.tiles - 1), at = first;
  while (at.y <= last.y) {
    vec3 other_low, other_high;
    if (range_of(at, other_low, other_high)) {
      low = min(low, other_low);
      high = max(high, other_high);
    }
    bool row_ends = at.x == last.x;
    at = row_ends ? ivec2(first.x, at.y + 1) : at + ivec2(1, 0);
  }
  return squared_range(low, high);
}

// Returns the mean of the squared ranges of the tile and those around, with binomial weights. It
// changes less than a single range while an edge of light moves from tile to tile.
float mean_squared_range(ivec2 tile) {
  float sum = 0.0;
  [[dont_unroll]] for (int i = 0; i < 9; ++i) {
    ivec2 side = ivec2(i % 3, i / 3) - 1, at = tile + side;
    bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, frame.tiles));
    vec3 low, high;
    bool known = range_of(clamp(at, ivec2(0), frame.tiles - 1), low, high);
    float weight = (side.x == 0 ? 0.5 : 0.25) * (side.y == 0 ? 0.5 : 0.25);
    sum += inside && known ? weight * squared_range(low, high) : 0.0;
  }
  return sum;
}

float mean_importance(ivec2 tile) {
  if (!has_importance())
    return 1.0;
  float sum = 0.0;
  ivec2 last = frame.rect.zw - 1;
  for (int i = importance_step / 2; i < 64; i += importance_step * (i % 8 < 6 ? 1 : 5)) {
    ivec2 pixel = min(8 * tile + ivec2(i & 7, i >> 3), last);
    sum += clean_importance(texelFetch(importance_image, texel_of(pixel), 0).r);
  }
  return sum / 16.0;
}

// Returns a pixel of the tile with subsurface, and its view depth; depth 0: no pixel has a depth.
// `full`: all pixels have subsurface.
ivec2 pixel_with_subsurface(ivec2 tile, bool full, out float depth) {
  ivec2 pixel = 8 * tile + 4, last = frame.rect.zw - 1;
  depth = 0.0;
  for (int i = 0; i < 64 && !(depth > 0.0); ++i) {
    // From pixels near the centre to all others: an odd factor permutes the 64 pixels.
    int at = (36 + 27 * i) & 63;
    pixel = min(8 * tile + ivec2(at & 7, at >> 3), last);
    ivec2 texel = texel_of(pixel);
    if (full || texelFetch(material_image, texel, 0).r != 0u)
      depth = view_depth(texelFetch(depth_image, texel, 0).r);
  }
  return pixel;
}

bool is_known(previous_position place) {
  return place.depth > 0.0 && all(lessThan(abs(place.pixel), vec2(reproject_largest_velocity)));
}

struct earlier_weights {
  float mean; // 0 to 1
  bool kept;  // a weight of the tile may not fall to 0
  uint level;
};

// Returns the weights of the part of the previous frame that moved into the tile. All of the tile
// moves as one of its pixels.
earlier_weights weights_before(ivec2 tile, bool full) {
  float depth;
  ivec2 pixel = pixel_with_subsurface(tile, full, depth), texel = texel_of(pixel);
  previous_position place = reproject(vec2(pixel), depth);
  if (has_velocity()) {
    previous_position moved =
        reproject(vec2(pixel), depth, texelFetch(velocity_image, texel, 0).rgb);
    if (is_known(moved)) // a velocity may be no number
      place = moved;
  }
  if (!(depth > 0.0) || !is_known(place))
    return earlier_weights(0.0, false, max_selection_level);
  vec2 corner = vec2(8 * tile - pixel) + place.pixel;
  ivec2 end = frame.previous_rect.zw - 1, first = max(ivec2(floor(corner)), ivec2(0)),
        last = min(ivec2(ceil(corner)) + 7, end);
  uint largest = 0u, sum = 0u, count = 0u;
  for (ivec2 at = first; all(lessThanEqual(at, last));) {
    // A word holds four weights of a row.
    int tile_before = (at.y >> 3) * ((frame.previous_rect.z + 7) >> 3) + (at.x >> 3);
    uint state = state_of_word(states_before_data[tile_before]);
    uint place_of_word = uint(tile_before) * words_per_tile + weight_word(uvec2(at));
    uint word = is_listed(state)             ? pixel_weights_before_data[place_of_word]
                : state == state_unscattered ? 0u
                                             : ~0u;
    int next = min((at.x & ~3) + 3, last.x) + 1;
    for (int x = at.x; x < next; ++x) {
      uint weight = word >> (8 * (x & 3)) & 0xffu;
      bool valid = weight != no_pixel_weight;
      largest = max(largest, valid ? weight : 0u);
      sum += valid ? weight : 0u;
      count += valid ? 1u : 0u;
    }
    at = next > last.x ? ivec2(first.x, at.y + 1) : ivec2(next, at.y);
  }
  uint level = min(largest * max_selection_level / highest_level_weight, max_selection_level);
  return earlier_weights(float(sum) / float(max(count, 1u) * full_pixel_weight),
                         largest > pixel_weight_step, count > 0u ? level : max_selection_level);
}

void main() {
  int index = int(gl_GlobalInvocationID.x);
  if (index >= frame.tiles.x * frame.tiles.y)
    return;
  uint change = 0u, entry = classes_data[index];
  if (class_of_tile(entry) == class_scatter) {
    ivec2 tile = ivec2(index % frame.tiles.x, index / frame.tiles.x);
    float d_px = uintBitsToFloat(light_range_data[index].w);
    int reach = clamp(int(ceil(tiles_per_d * d_px)), 1, max_reach);
    float ranges =
        mean_squared_range(tile) + reached_fraction * squared_range_around(tile, reach);
    float importance = mean_importance(tile);
    float amount = ranges * importance * importance * min(d_px / full_change_d_px, 1.0);
    earlier_weights before = earlier_weights(0.0, false, max_selection_level);
    if (has_states_before() && has_pixel_weights_before() && history_usable())
      before = weights_before(tile, (entry & class_full_bit) != 0u);
    amount *= mix(1.0, selection_stay, before.mean);
    change = uint(amount * change_steps + 0.5) | before.level << selection_level_shift |
             (before.kept ? selection_kept_bit : 0u);
  }
  tile_changes_data[index] = change;
}
