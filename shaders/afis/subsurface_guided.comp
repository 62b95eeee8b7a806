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

const float first_count = 16.0;  // samples of a pixel without history
// offset in the sequence from frame to frame, whatever number of points a pixel uses
const uint frame_stride = 61u;

vec3 scatter_light(scatter_point point, scatter_profile profile, vec4 own, sample_set set) {
  afis_settings chosen = afis_settings(settings.lod_bias, settings.sequence, settings.channels,
                                       settings.inverse, settings.weighting, settings.surface,
                                       settings.direct, settings.estimator, settings.mips);
  return scatter(chosen, set, point, profile, own, material_image, depth_image, slope_image,
                 light_image, levels_image);
}

guidance_settings guidance() {
  return guidance_settings(settings.sigma2_target, settings.kappa, settings.eta, settings.eta_cv,
                           settings.eps_alpha, settings.min_samples, settings.max_samples);
}

bool splits() { return settings.guidance == GUIDANCE_SPLIT_HALF; }
bool has_moments() { return settings.guidance == GUIDANCE_OCV; }

vec4 guide_before(ivec2 pixel) { return texelFetch(guide_image, previous_texel(pixel), 0); }

// The split-half estimator keeps depth (metres) in the guide image; the other estimators keep depth
// in the place image.
vec2 surface_before(ivec2 pixel) {
  vec2 kept = guide_before(pixel).ba;
  float depth = splits() ? kept.r : texelFetch(place_image, previous_texel(pixel), 0).r;
  return vec2(depth * mm_per_metre, kept.g);
}

history_taps find_history(previous_place place, uint id, float tolerance) {
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
  guide_state state = guide_state(sqrt(settings.sigma2_target), first_count, 0.0,
                                  moving_covariance(0.0, 0.0, 0.0, 0.0), true);
  if (!(history_usable() && depth > 0.0))
    return state;
  previous_place place =
      has_velocity() && depth > 0.0
          ? place_before(vec2(pixel), depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
          : place_before(vec2(pixel), depth);
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

// By pixel of the tile. x: squared half difference of the pixel's two halves, times the number of
// samples. y: profile, 0 if nothing was sampled.
shared vec2 spreads[64];

// Returns the variance of one sample, pooled over the tile's pixels of a profile, because the
// difference of a single pixel is too noisy.
float pooled_spread(float id) {
  vec2 sum = vec2(0.0);
  for (uint i = 0u; i < 64u; ++i)
    sum += spreads[i].y == id ? vec2(spreads[i].x, 1.0) : vec2(0.0);
  return sum.x / sum.y;
}

struct guided_pixel {
  ivec2 pixel;
  vec3 light;
  float depth;
  uint id; // 0: nothing to sample
  scatter_profile profile;
  float alpha;
};

struct sampled_light {
  vec3 first, last; // of both halves of the samples; equal to each other if they are not split
};

// A loop over the halves, because a driver then compiles the samples only once.
sampled_light sample_light(guided_pixel at, int count, uint first) {
  scatter_point point =
      scatter_point(at.pixel, at.id, at.depth, view_position(vec2(at.pixel), at.depth));
  vec4 own = vec4(at.light, at.alpha);
  uint parts = splits() ? 2u : 1u;
  sampled_light light;
  for (uint part = 0u; part < parts; ++part) {
    light.last = scatter_light(point, at.profile, own,
                               sample_set(part, count / int(parts), count, first));
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

// Updates the moments of the observed value (Algorithms 1 to 3). `before` is the light that was not
// scattered.
void watch(vec3 before, vec3 light, inout guide_state state) {
  float g = exposed(before), f = exposed(light);
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

void main() {
  guided_pixel at;
  at.pixel = ivec2(0);
  bool copy_only = false;
  uint tile = listed_tile();
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], at.pixel, copy_only);
  ivec2 texel = ivec2(0);
  at.id = 0u;
  at.depth = 0.0;
  at.light = vec3(0.0);
  guide_state state = guide_state(0.0, 0.0, 0.0, moving_covariance(0.0, 0.0, 0.0, 0.0), false);
  int count = 0;
  uint id = 0u;
  if (listed) {
    texel = texel_of(at.pixel);
    id = texelFetch(material_image, texel, 0).r;
    vec4 light = texelFetch(light_image, texel, 0);
    at.light = light.rgb;
    at.alpha = light.a;
    at.depth = view_depth(texelFetch(depth_image, texel, 0).r);
    if (id != 0u && !copy_only && at.depth > 0.0) {
      float scale = has_scatter_scale()
                        ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                        : 1.0;
      at.profile = find_profile(id, scale);
      if (projected_d(at.profile.d.w, at.depth) >= copy_below_d_px)
        at.id = id;
    }
  }
  float spread = 0.0;
  if (at.id != 0u) {
    vec2 footprint = pixel_footprint(at.depth);
    state = state_before(at.pixel, at.depth, at.id,
                         length(texelFetch(slope_image, texel, 0).rg * footprint));
    float required = required_samples(state.sd * state.sd, state.mean_count, guidance());
    count = clamped_samples(required, guidance());
    if (splits())
      count += count & 1;
    sampled_light light = sample_light(at, count, frame.frame_index * frame_stride);
    if (splits()) {
      spread = spread_of(light, count);
      at.light = 0.5 * (light.first + light.last);
    } else {
      watch(at.light, light.last, state);
      at.light = light.last;
    }
  }
  if (splits()) {
    spreads[gl_LocalInvocationIndex] = vec2(spread, float(at.id));
    barrier();
    if (at.id != 0u && !state.lost)
      state.sd =
          sqrt(mix(state.sd * state.sd, pooled_spread(float(at.id)) / float(count), settings.eta));
  }
  if (!listed)
    return;
  if (at.id != 0u)
    state.mean_count =
        state.lost ? float(count) : mix(state.mean_count, float(count), settings.eta);
  imageStore(scattered_image, texel, vec4(round_to_half(at.light), 1.0));
  float depth = at.depth / mm_per_metre;
  imageStore(
      guide_out_image, texel,
      round_to_half(vec4(state.sd, state.mean_count, splits() ? depth : state.mean, float(id))));
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
