#version 460
// Temporal anti-aliasing: filters this frame's samples about the pixel's centre and blends them
// into the history found by velocity, clipped to the surrounding colours.

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, std140) uniform Constants {
  vec2 jitter; // pixels: this frame's samples lie at their pixel minus this
  uint begins; // 1: no history
  uint unused;
} constants;
layout(set = 0, binding = 1) uniform sampler2D color_image;
layout(set = 0, binding = 2) uniform sampler2D velocity_image;
layout(set = 0, binding = 3) uniform sampler2D history_image;
layout(set = 0, binding = 4, rgba32f) uniform writeonly image2D resolved_image;

const float new_fraction = 0.1; // weight of this frame in the long run
const float clip_deviations = 1.25;
// exp(this * squared pixels) is close to a Blackman-Harris window (Karis 2014)
const float filter_width = -2.29;
const float snap = 1.0 / 256.0;   // pixels; a static camera must not blur

// Converts to luma and two chromas, in which the box around colours is smaller than in red, green
// and blue.
vec3 to_ycocg(vec3 c) {
  return vec3(0.25 * c.r + 0.5 * c.g + 0.25 * c.b, 0.5 * c.r - 0.5 * c.b,
              -0.25 * c.r + 0.5 * c.g - 0.25 * c.b);
}
vec3 from_ycocg(vec3 c) { return vec3(c.x + c.y - c.z, c.x + c.z, c.x - c.y - c.z); }

vec4 catmull_rom(float t) {
  float t2 = t * t, t3 = t2 * t;
  return 0.5 *
         vec4(-t3 + 2.0 * t2 - t, 3.0 * t3 - 5.0 * t2 + 2.0, -3.0 * t3 + 4.0 * t2 + t, t3 - t2);
}

vec4 history_at(vec2 place, ivec2 size) {
  vec2 whole = round(place);
  place = mix(place, whole, lessThan(abs(place - whole), vec2(snap)));
  ivec2 first = ivec2(floor(place));
  vec2 part = place - vec2(first);
  vec4 across = catmull_rom(part.x), down = catmull_rom(part.y), sum = vec4(0.0);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      if (across[x] * down[y] != 0.0)
        sum += across[x] * down[y] *
               texelFetch(history_image, clamp(first + ivec2(x, y) - 1, ivec2(0), size - 1), 0);
  return max(sum, vec4(0.0));
}

void main() {
  ivec2 size = textureSize(color_image, 0), pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  vec3 filtered = vec3(0.0), sum = vec3(0.0), squares = vec3(0.0);
  float weights = 0.0, count = 0.0;
  vec3 own = to_ycocg(texelFetch(color_image, pixel, 0).rgb);
  vec2 fastest = vec2(0.0);
  float maximum = -1.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 q = clamp(pixel + ivec2(x, y), ivec2(0), size - 1);
      vec3 color = to_ycocg(texelFetch(color_image, q, 0).rgb) - own;
      vec2 offset = vec2(x, y) - constants.jitter;
      float weight = exp(filter_width * dot(offset, offset));
      filtered += weight * color;
      weights += weight;
      sum += color;
      squares += color * color;
      count += 1.0;
      // The longest velocity around moves edges with their object.
      vec2 velocity = texelFetch(velocity_image, q, 0).xy;
      if (dot(velocity, velocity) > maximum) {
        maximum = dot(velocity, velocity);
        fastest = velocity;
      }
    }
  filtered = own + filtered / weights;
  vec3 mean = sum / count, deviation = sqrt(max(squares / count - mean * mean, vec3(0.0)));
  mean += own;
  vec3 color = filtered;
  float frames = 0.0;
  vec2 place = vec2(pixel) - fastest;
  bool seen = all(greaterThan(place, vec2(-0.5))) && all(lessThan(place, vec2(size) - 0.5));
  if (constants.begins == 0u && seen) {
    vec4 found = history_at(place, size);
    vec3 history = to_ycocg(found.rgb), way = abs(history - mean),
         box_half = clip_deviations * deviation;
    float keep = 1.0;
    for (int c = 0; c < 3; ++c)
      if (way[c] > box_half[c]) keep = min(keep, box_half[c] / way[c]);
    history = mix(mean, history, keep);
    frames = found.a;
    color = mix(history, filtered, max(new_fraction, 1.0 / (frames + 1.0)));
  }
  imageStore(resolved_image, pixel,
             vec4(max(from_ycocg(color), vec3(0.0)), min(frames + 1.0, 1.0 / new_fraction)));
}
