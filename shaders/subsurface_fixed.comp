#version 460
// Plain importance sampling of the widest channel at n points of the R2 sequence, turned anew for every pixel and
// frame: no mips, no history. What lies within the direct radius is the pixel's own light.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_fixed.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "radius.glsl"
#include "half.glsl"
#include "hash.glsl"
#include "tap.glsl"

// R2 (Roberts 2018): multiples of 1/g and 1/g^2 with g^3 = g + 1, in 32-bit fixed point so that no index loses digits.
const uvec2 r2_step = uvec2(3242174889u, 2447445414u);

// The sampler that the settings ask for. Burley's profile alone has a choice of inverses; other models are sampled by
// their table with its own density.
radial_sample draw(scatter_profile profile, float survival) {
  if (profile.row != no_radial_row || settings.inverse == INVERSE_POLYNOMIAL) {
    radial_sample drawn = profile_sample(profile, survival);
    if (settings.weighting == WEIGHTING_PROFILE && profile.row == no_radial_row)
      drawn.density = burley_pdf(drawn.r, profile.d.w);
    return drawn;
  }
  bool exact = settings.inverse == INVERSE_EXACT;
  float r = exact ? burley_inverse_survival(survival, profile.d.w) : burley_approximate_survival(survival, profile.d.w);
  float density = burley_pdf(r, profile.d.w);
  if (!exact && settings.weighting == WEIGHTING_SAMPLER)
    density /= burley_approximate_weight(survival);
  return radial_sample(r, density);
}

vec3 scatter(scatter_point point, scatter_profile profile, float area, vec3 own) {
  vec2 footprint = pixel_footprint(point.depth);
  uvec3 hash = pcg3d(uvec3(point.pixel, frame.frame_index));
  uint widest = profiles[min(point.id, 255u)].widest;

  // Samples are drawn beyond the direct radius only; it follows from the sampler itself, so that what it leaves out is
  // what is taken from the pixel's own light.
  vec3 direct = vec3(0.0);
  float beyond = 1.0;
  if (settings.direct != DIRECT_NONE) {
    float r0 = settings.direct == DIRECT_INSCRIBED ? 0.5 * min(footprint.x, footprint.y) : 0.5 * length(footprint);
    beyond = profile_survival(profile, r0)[widest];
    r0 = draw(profile, beyond).r;
    direct = 1.0 - profile_survival(profile, r0 * sqrt(area));
  }
  vec3 sum = vec3(0.0), total = vec3(0.0);
  for (int i = 0; i < settings.samples; ++i) {
    vec2 unit = (vec2((hash.xy + uint(i) * r2_step) >> 8) + 0.5) * (1.0 / 16777216.0);
    radial_sample drawn = draw(profile, unit.x * beyond);
    vec2 offset = drawn.r * vec2(cos(unit.y * two_pi), sin(unit.y * two_pi));
    vec3 weight, light;
    if (!take_tap(point, profile, vec2(point.pixel) + offset / footprint, drawn, weight, light))
      continue;
    sum += weight * light;
    total += weight;
  }
  float each = beyond / float(settings.samples);
  vec3 mean = direct * own + each * sum;
  if (settings.normalise == NORMALISE_SELF) {
    vec3 mass = direct + each * total;
    mean = mix(own, mean / max(mass, vec3(1e-30)), greaterThan(mass, vec3(1e-30)));
  }
  mean = mix(own, mean, greaterThan(profile.d.rgb, vec3(0.0)));
  return mix(mean, own, profile_direct(point.id));
}

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = texelFetch(material_image, texel, 0).r;
  if (id == 0u)
    return;
  vec4 light = texelFetch(light_image, texel, 0);
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
    scatter_profile profile = find_profile(id, scale);
    if (projected_d(profile.d.w, depth) >= copy_below_d_px)
      light.rgb = scatter(scatter_point(pixel, id, depth, view_position(vec2(pixel), depth)), profile, light.a, light.rgb);
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light.rgb), 1.0));
}
