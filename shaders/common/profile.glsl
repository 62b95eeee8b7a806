// A pixel's profile for any model: Burley's closed forms, or the rows of
// passes/common/profiles/radial_table.hpp. Lengths are in mm.
#ifndef DERMIS_PROFILE_GLSL
#define DERMIS_PROFILE_GLSL

#include "common/burley.glsl"
#include "constants.glsl"
#include "common/environment.glsl"

const uint no_radial_row = 0xffffffffu;

struct scatter_profile {
  // rgb: d per channel, a: d of the widest channel; both include the pixel's scale.
  vec4 d;
  float scale; // the pixel's scatter_scale, > 0
  uint row;    // row of the radial table
};

scatter_profile find_profile(uint id, float scale) {
  profile_entry entry = profiles[min(id, 255u)];
  return scatter_profile(entry.d_mm * scale, scale, entry.radial_row);
}

// Computes the node below `position` and the fraction of the distance to the next node.
void radial_place(float position, out int low, out float part) {
  position = clamp(position, 0.0, float(radial_nodes - 1));
  low = min(int(position), radial_nodes - 2);
  part = position - float(low);
}
float radial_position(float d, float r) {
  return (log2(max(r / d, 1e-30)) - radial_log2_r_first) * radial_nodes_per_octave;
}

// Returns 2 pi R_c(r), per mm^2.
vec3 profile_falloff(scatter_profile profile, float r) {
  if (profile.row == no_radial_row) {
    vec3 inverse_d = 1.0 / max(profile.d.rgb, vec3(1e-30));
    vec3 e = exp(-r * inverse_d * (1.0 / 3.0));
    return 0.25 * inverse_d * (e * e * e + e) / r;
  }
  int low;
  float part;
  radial_place(radial_position(profile.d.w, r), low, part);
  low += int(profile.row);
  return exp2(mix(radial_rows[low].rgb, radial_rows[low + 1].rgb, part)) /
         (profile.scale * profile.scale);
}

// Returns the fraction of the scattered energy beyond r.
vec3 profile_survival(scatter_profile profile, float r) {
  if (profile.row == no_radial_row) {
    vec3 e = exp(-r / (3.0 * max(profile.d.rgb, vec3(1e-30))));
    return 0.25 * e * e * e + 0.75 * e;
  }
  int low;
  float part, position = radial_position(profile.d.w, r);
  radial_place(position, low, part);
  low += int(profile.row) + radial_nodes;
  // The kernel is flat below the first node, so that energy grows with the square of the radius.
  if (position < 0.0)
    return 1.0 - (1.0 - radial_rows[low].rgb) * exp2(2.0 * position / radial_nodes_per_octave);
  return mix(radial_rows[low].rgb, radial_rows[low + 1].rgb, part);
}

struct radial_sample {
  float r;
  float density; // exact density of the sampler at r
};

// Returns the radius of the widest channel for survival u, by the row of inverses.
radial_sample profile_sample_row(scatter_profile profile, float u) {
  u = clamp(u, burley_min_survival, 1.0);
  float root = sqrt(max(-log2(u), 1e-7));
  int low;
  float part;
  radial_place(root * radial_inverse_nodes_per_unit, low, part);
  low += int(profile.row);
  float near = radial_rows[low].a * profile.scale, far = radial_rows[low + 1].a * profile.scale;
  return radial_sample(mix(near, far, part),
                       2.0 * root * u * log(2.0) / ((far - near) * radial_inverse_nodes_per_unit));
}

radial_sample profile_sample(scatter_profile profile, float u) {
  if (profile.row != no_radial_row)
    return profile_sample_row(profile, u);
  float r = burley_sample_survival(u, profile.d.w);
  return radial_sample(r, burley_pdf(r, profile.d.w) / burley_sample_weight(u));
}

#endif
