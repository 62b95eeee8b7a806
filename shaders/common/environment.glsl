// Bindings that every kernel sees in addition to its ports: descriptor set 1. Mirrors
// passes/common/environment.hpp.
#ifndef DERMIS_ENVIRONMENT_GLSL
#define DERMIS_ENVIRONMENT_GLSL

layout(std140, set = 1, binding = 0) uniform frame_block {
  ivec4 rect;        // x, y, width, height of the render rectangle, pixels
  ivec2 tiles;       // 8x8 tiles of the rectangle
  uint frame_index;
  // bit 0: perspective, bit 1: depth is view depth, bit 2: history invalid, bit 3: the frame
  // before was perspective, bit 4: normal images are left-handed, bit 5: the error is probed
  // whatever the interval between probed frames
  uint flags;
  vec2 ray_scale;    // view x, y = (scale * pixel + offset) * (perspective ? depth : 1), mm
  vec2 ray_offset;
  vec4 depth_decode; // depth mm = (a * value + b) / (c * value + e)
  float depth_unit;  // mm per unit of view depth
  float exposure;
  vec2 jitter;       // pixels
  // The previous frame, down to previous_jitter; valid if bit 2 of flags is not set.
  // Rows of M: the view position (mm) in the previous frame of a static point = M * (view position,
  // 1).
  vec4 previous_from_view[3];
  vec2 previous_ray_scale;    // same convention as ray_scale, ray_offset
  vec2 previous_ray_offset;
  ivec4 previous_rect;
  vec2 previous_jitter; // pixels
  uint sample_units; // that subsurface.allocate_samples may spend
  uint view_frame;   // 1 in a cut, and one more in each further frame of the view
  // x, y, width, height of the area that may have subsurface, from the rectangle's corner
  ivec4 bounds;
  // Rows of M: view position (mm) = M * (world position in the host's units, 1).
  vec4 view_from_world[3];
} frame;

struct profile_entry {
  vec4 d_mm;   // rgb: shape parameter per channel, a: shape parameter of the widest channel
  uint widest; // index of the widest channel
  uint separable_row;
  uint radial_row; // 0xffffffff: Burley's closed forms
  uint sap_table;  // 0: the shared table
  vec4 direct;     // rgb: fraction of light that never scatters
};
layout(std430, set = 1, binding = 1) readonly buffer profile_block { profile_entry profiles[]; };
layout(std430, set = 1, binding = 4) readonly buffer sap_block { vec4 sap_table[]; };
layout(std430, set = 1, binding = 5) readonly buffer radial_block { vec4 radial_rows[]; };
layout(std430, set = 1, binding = 2) readonly buffer separable_block { vec4 separable_rows[]; };

// Returns the fraction of light that never scatters.
vec3 profile_direct(uint id) { return profiles[min(id, 255u)].direct.rgb; }

// Returns the profile of a material id: ids above 255 count as 255.
uint profile_of(uint material) { return min(material, 255u); }

const float largest_depth_mm = 1e9; // 1000 km; sky and infinite far planes are beyond
// Footprints of pixels that are closer would underflow.
const float smallest_depth_mm = 1e-6;

bool is_perspective() { return (frame.flags & 1u) != 0u; }

// Returns the view depth in mm from a value of the depth import, 0 if nothing is visible. Both
// decodings are computed, because some drivers compile a kernel again at each bind for a branch
// that is uniform over the dispatch.
float view_depth(float value) {
  float distance = value * frame.depth_unit;
  float decoded = (frame.depth_decode.x * value + frame.depth_decode.y) /
                  (frame.depth_decode.z * value + frame.depth_decode.w);
  float depth = (frame.flags & 2u) != 0u ? distance : decoded;
  // NaN and Inf compare false
  return depth > smallest_depth_mm && depth < largest_depth_mm ? depth : 0.0;
}

// Returns the size of a pixel across the view at a depth, in mm in x and y.
vec2 pixel_footprint(float depth) {
  return abs(frame.ray_scale) * (is_perspective() ? depth : 1.0);
}

// Returns the view position in mm: x right, y up, the camera looks along -z. Integers are pixel
// centres, counted from the rectangle's corner.
vec3 view_position(vec2 pixel, float depth) {
  return vec3((frame.ray_scale * pixel + frame.ray_offset) * (is_perspective() ? depth : 1.0),
              -depth);
}

// Returns the normal in view space (as view_position) for a texel of the host's normal image.
vec3 view_normal(vec3 stored) {
  return (frame.flags & 16u) != 0u ? vec3(stored.xy, -stored.z) : stored;
}

bool inside_rect(ivec2 pixel) {
  return all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, frame.rect.zw));
}

// Returns whether the pixel is in the area of the rectangle that may have subsurface, according to
// the host.
bool inside_bounds(ivec2 pixel) {
  ivec2 from = pixel - frame.bounds.xy;
  return all(greaterThanEqual(from, ivec2(0))) && all(lessThan(from, frame.bounds.zw));
}

// Returns the texel of a pixel of the rectangle.
ivec2 texel_of(ivec2 pixel) { return pixel + frame.rect.xy; }

#endif
