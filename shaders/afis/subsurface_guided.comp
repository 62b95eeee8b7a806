#version 460
// Filtered importance sampling with a number of samples that depends on the variance of the pixel's
// earlier results.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "afis/subsurface_guided.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "afis/afis.glsl"
#include "afis/guidance.glsl"
#include "common/radius.glsl"
#include "common/reproject.glsl"

// offset in the sequence from frame to frame, whatever number of points a pixel uses
const uint frame_stride = 61u;

afis_settings estimator() {
  return afis_settings(settings.lod_bias, settings.sequence, settings.channels, settings.inverse,
                       settings.weighting, settings.surface, settings.direct, settings.estimator,
                       settings.mips);
}

guidance_settings guidance() {
  return guidance_settings(settings.sigma2_target, settings.kappa, settings.eta, settings.eta_cv,
                           settings.eps_alpha, settings.min_samples, settings.max_samples);
}

bool splits() { return settings.guidance == GUIDANCE_SPLIT_HALF; }
bool pools() { return settings.pool == POOL_TILE && !splits(); }
bool has_moments() { return settings.guidance == GUIDANCE_OCV; }

vec4 guide_before(ivec2 pixel) { return texelFetch(guide_image, previous_texel(pixel), 0); }

// The split-half estimator keeps depth (metres) in the guide image; the other estimators keep depth
// in the place image.
vec2 surface_before(ivec2 pixel) {
  vec2 kept = guide_before(pixel).ba;
  float depth = splits() ? kept.r : texelFetch(place_image, previous_texel(pixel), 0).r;
  return vec2(depth * mm_per_metre, kept.g);
}

history_taps find_history(previous_position place, uint id, float tolerance) {
  history_taps taps = taps_around(place);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0 &&
        !shows_surface(surface_before(tap_pixel(taps, i)), place, id, tolerance))
      taps.weight[i] = 0.0;
  return normalised_taps(taps);
}

struct guide_state {
  // sd: standard deviation of one frame's exposed luminance. mean_count: mean number of samples.
  // mean: mean of the observed value.
  float sd, mean_count, mean;
  moving_covariance moments;
  bool lost;
};

guide_state state_before(ivec2 pixel, float depth, uint id, float rise) {
  guide_state state = guide_state(sqrt(settings.sigma2_target), float(settings.first_samples), 0.0,
                                  moving_covariance(0.0, 0.0, 0.0, 0.0), true);
  if (!(history_usable() && depth > 0.0))
    return state;
  previous_position place =
      has_velocity() && depth > 0.0
          ? reproject(vec2(pixel), depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
          : reproject(vec2(pixel), depth);
  history_taps taps = find_history(place, id, depth_tolerance(place.depth, rise));
  if (taps.weight == vec4(0.0))
    return state;
  vec4 guide = vec4(0.0), control = vec4(0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0) {
      ivec2 at = tap_pixel(taps, i);
      guide += taps.weight[i] * guide_before(at);
      if (has_moments())
        control += taps.weight[i] * texelFetch(control_image, previous_texel(at), 0);
    }
  // The control image stores the weight, the sd of g and both means, because half floats can hold
  // these but not a covariance.
  float variance_g = control.g * control.g;
  return guide_state(guide.r, guide.g, guide.b,
                     moving_covariance(control.b, control.a, control.r * variance_g, variance_g),
                     false);
}

float exposed(vec3 light) { return min(dot(light, luminance_weights) * frame.exposure, 1e4); }

// Four pixels of the tile per element: a value that guides the number of samples, and the profile,
// 0 if the pixel has no value.
shared vec4 pooled_values[16], pooled_profiles[16];

// Returns the mean of `value` over the tile's pixels of a profile that have a value, because that
// of a single pixel is too noisy. Returns the pixel's own value if there is none. All invocations
// of the group call it.
float mean_in_tile(float value, uint id, bool has_value) {
  uint element = gl_LocalInvocationIndex >> 2, component = gl_LocalInvocationIndex & 3u;
  pooled_values[element][component] = value;
  pooled_profiles[element][component] = has_value ? float(id) : 0.0;
  barrier();
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < 16u; ++i) {
    vec4 values = pooled_values[i];
    vec4 same = vec4(equal(pooled_profiles[i], vec4(float(id))));
    for (uint k = 0u; k < 4u; ++k)
      sum += same[k] * vec2(values[k], 1.0);
  }
  return sum.y > 0.0 ? sum.x / sum.y : value;
}

// Returns the maximum number of samples in a tile. It doubles with each step of samples.
int max_samples_at(ivec2 tile) {
  uint steps =
      has_samples_per_tile() ? samples_per_tile_data[tile.y * frame.tiles.x + tile.x] : 3u;
  return max(settings.max_samples >> (3u - min(steps, 3u)), splits() ? 2 : 1);
}

struct guided_pixel {
  scatter_point point; // id 0: nothing to sample
  vec4 own;            // light, and area of the patch
  scatter_profile profile;
};

struct sampled_light {
  vec3 first, last; // of both halves of the samples; equal to each other if they are not split
};

// A loop over the halves, because a driver then compiles the samples only once.
sampled_light sample_light(guided_pixel at, direct_part direct, int count) {
  uint parts = splits() ? 2u : 1u;
  sampled_light light;
  for (uint part = 0u; part < parts; ++part) {
    sample_set set =
        sample_set(part, count / int(parts), count, frame.frame_index * frame_stride);
    light.last = scatter(estimator(), direct, set, at.point, at.profile, at.own, material_image,
                         depth_image, slope_image, light_image, levels_image);
    if (part == 0u)
      light.first = light.last;
  }
  return light;
}

// Returns the squared half difference of both halves, times the number of samples.
float spread_of(sampled_light light, int count) {
  float half_way = 0.5 * (exposed(light.first) - exposed(light.last));
  return half_way * half_way * float(count);
}

// Holds the values that guidance watches (equations 29, 30 and 37).
struct observed_light {
  float distant; // f: the estimate without the direct part
  float control; // G
};

observed_light observe(guided_pixel at, direct_part direct, vec3 light) {
  vec3 control = at.own.rgb;
  if (settings.control == CONTROL_MEAN) {
    float level = log2(projected_d(at.profile.d.w, at.point.depth)) + settings.control_level;
    control = filtered_light(levels_image, MIPS_TRILINEAR, vec2(at.point.pixel), level, control);
  }
  return observed_light(exposed(max(light - direct.fraction * at.own.rgb, vec3(0.0))),
                        exposed((1.0 - direct.fraction) * control));
}

// Updates the moments of the observed value (Algorithms 1 to 3).
void watch(observed_light observed, inout guide_state state) {
  float g = observed.control, f = observed.distant;
  if (state.lost)
    state.moments = moving_covariance(f, g, 0.0, 0.0);
  float weight = settings.guidance == GUIDANCE_SPVG ? 0.0 : 1.0;
  if (has_moments())
    weight = control_weight(state.moments, settings.eps_alpha);
  float watched = f - weight * g;
  moving_variance moments = moving_variance(state.lost ? watched : state.mean, state.sd * state.sd);
  if (!state.lost)
    moments = add_value(moments, watched, settings.eta);
  state.mean = moments.mean;
  state.sd = sqrt(moments.variance);
  if (has_moments() && !state.lost)
    state.moments = add_values(state.moments, f, g, settings.eta_cv);
}

// Algorithm 1: nothing is sampled if too little light leaves the pixel. gamma as published, beyond
// the circumscribed radius.
bool leaves_pixel(scatter_profile profile, uint widest, float depth) {
  return profile_survival(profile, 0.5 * length(pixel_footprint(depth)))[widest] >= settings.eps_u;
}

void main() {
  ivec2 pixel = ivec2(0), texel = ivec2(0);
  bool copy_only = false;
  uint tile = listed_tile();
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  guided_pixel at;
  at.point = scatter_point(pixel, 0u, 0.0, vec3(0.0));
  at.own = vec4(0.0);
  uint id = 0u;
  if (listed) {
    texel = texel_of(pixel);
    id = profile_of(texelFetch(material_image, texel, 0).r);
    at.own = texelFetch(light_image, texel, 0);
    at.point.depth = view_depth(texelFetch(depth_image, texel, 0).r);
    if (id != 0u && !copy_only && at.point.depth > 0.0) {
      float scale = has_scatter_scale()
                        ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                        : 1.0;
      at.profile = find_profile(id, scale);
      if (projected_d(at.profile.d.w, at.point.depth) >= copy_below_d_px &&
          leaves_pixel(at.profile, profiles[min(id, 255u)].widest, at.point.depth))
        at.point.id = id;
    }
  }
  bool sampled = at.point.id != 0u;
  guide_state state = guide_state(0.0, 0.0, 0.0, moving_covariance(0.0, 0.0, 0.0, 0.0), false);
  if (sampled) {
    at.point.position = view_position(vec2(pixel), at.point.depth);
    state = state_before(
        pixel, at.point.depth, id,
        length(texelFetch(slope_image, texel, 0).rg * pixel_footprint(at.point.depth)));
  }
  float required = required_samples(state.sd * state.sd, state.mean_count, guidance());
  if (pools()) // Bounded, so that a few pixels at edges do not decide for all.
    required = mean_in_tile(min(required, float(settings.max_samples)), at.point.id, !state.lost);
  int count = 0;
  float spread = 0.0;
  vec3 scattered = at.own.rgb;
  if (sampled) {
    count = min(clamped_samples(required, guidance()), max_samples_at(pixel >> 3));
    if (splits())
      count += count & 1;
    direct_part direct = direct_of(estimator(), at.point, at.profile, at.own.a);
    sampled_light light = sample_light(at, direct, count);
    if (splits()) {
      spread = spread_of(light, count);
      scattered = 0.5 * (light.first + light.last);
    } else {
      watch(observe(at, direct, light.last), state);
      scattered = light.last;
    }
  }
  if (splits()) {
    spread = mean_in_tile(spread, at.point.id, true);
    if (sampled && !state.lost)
      state.sd = sqrt(mix(state.sd * state.sd, spread / float(count), settings.eta));
  }
  if (!listed)
    return;
  if (sampled)
    state.mean_count =
        state.lost ? float(count) : mix(state.mean_count, float(count), settings.eta);
  imageStore(scattered_image, texel, vec4(round_to_half(scattered), 1.0));
  float depth = at.point.depth / mm_per_metre;
  // Without samples there is no history: the pixel starts anew when it scatters.
  vec4 guide = vec4(state.sd, state.mean_count, splits() ? depth : state.mean, float(at.point.id));
  imageStore(guide_out_image, texel, round_to_half(guide));
  if (has_place_out())
    imageStore(place_out_image, texel, vec4(round_to_half(depth), 0.0, 0.0, 0.0));
  if (has_control_out()) {
    float variance_g = state.moments.variance_g;
    vec4 control = vec4(variance_g > 0.0 ? state.moments.covariance / variance_g : 1.0,
                        sqrt(variance_g), state.moments.mean_f, state.moments.mean_g);
    imageStore(control_out_image, texel,
               settings.full_precision != 0 ? control : round_to_half(control));
  }
  if (has_sampling())
    imageStore(sampling_image, texel,
               vec4(float(count), state.mean_count, state.sd, state.lost ? 1.0 : 0.0));
}
