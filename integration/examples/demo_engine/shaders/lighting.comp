#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform sampler2D normal_image;
layout(set = 0, binding = 3) uniform sampler2D shading_image;
layout(set = 0, binding = 4) uniform sampler2D finish_image;
layout(set = 0, binding = 5) uniform sampler2DArrayShadow shadow_maps;
layout(set = 0, binding = 6, rgba16f) uniform writeonly image2D lighting_image;
layout(set = 0, binding = 7, rgba16f) uniform writeonly image2D specular_image;
layout(set = 0, binding = 8) uniform sampler2DArray shadow_depths; // the shadow maps as depths
layout(set = 0, binding = 9, r32f) uniform writeonly image2D thickness_image;
layout(set = 0, binding = 10, rgba16f) uniform writeonly image2D back_lighting_image;

// Returns the face of a point light's cube that contains direction d (world axes of the view): +x
// -x +y -y +z -z.
uint cube_face(vec3 d) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) return d.x > 0.0 ? 0u : 1u;
  if (a.y >= a.z) return d.y > 0.0 ? 2u : 3u;
  return d.z > 0.0 ? 4u : 5u;
}

// Computes the layer of the light's map that shows p, and the place of p in it. Returns false
// outside the map or without a map.
bool shadow_place(Light light, vec3 p, out uint layer, out vec3 place) {
  layer = light.shadow.x;
  place = vec3(0.0);
  if (layer == no_shadow) return false;
  if (uint(light.position.w) == light_point)
    layer += cube_face(transpose(mat3(frame.view_from_world)) * (p - light.position.xyz));
  vec4 s = frame.shadow_from_view[layer] * vec4(p, 1.0);
  if (s.w <= 0.0) return false;
  place = s.xyz / s.w;
  return all(lessThan(abs(place.xy), vec2(1.0))) && place.z <= 1.0;
}

// Returns the path length of light inside the object, from its first surface to p, in metres: the
// mean of 3x3 texels of the map. Negative: unknown.
float way_through(Light light, vec3 p, vec3 to_light) {
  uint layer;
  vec3 place;
  if (!shadow_place(light, p, layer, place)) return -1.0;
  mat4 view_from_shadow = inverse(frame.shadow_from_view[layer]);
  int side = textureSize(shadow_depths, 0).x;
  float sum = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      vec2 at = place.xy + 2.0 * vec2(x, y) / float(side);
      ivec2 texel = clamp(ivec2((at * 0.5 + 0.5) * float(side)), ivec2(0), ivec2(side - 1));
      vec4 entry =
          view_from_shadow * vec4(at, texelFetch(shadow_depths, ivec3(texel, layer), 0).r, 1.0);
      sum += max(0.0, dot(entry.xyz / entry.w - p, to_light));
    }
  return sum / 9.0;
}

// Returns the fraction of the light that reaches p: 3x3 comparisons, each bilinear.
float visibility(Light light, vec3 p, vec3 n, vec3 to_light) {
  if (light.shadow.x == no_shadow) return 1.0;
  uint layer = light.shadow.x;
  if (uint(light.position.w) == light_point) {
    vec3 world = transpose(mat3(frame.view_from_world)) * (p - light.position.xyz);
    layer += cube_face(world);
  }
  // Offsets p from the surface by about a texel, and more at grazing light.
  float sine = sqrt(max(0.0, 1.0 - dot(n, to_light) * dot(n, to_light)));
  vec4 s = frame.shadow_from_view[layer] * vec4(p + n * (0.0004 + 0.0012 * sine), 1.0);
  if (s.w <= 0.0) return 1.0;
  s.xyz /= s.w;
  if (any(greaterThan(abs(s.xy), vec2(1.0))) || s.z > 1.0) return 1.0;
  vec2 uv = s.xy * 0.5 + 0.5;
  float lit = 0.0;
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x)
      lit += texture(shadow_maps, vec4(uv + vec2(x, y) * frame.misc.z, float(layer), s.z));
  return lit / 9.0;
}

// GGX with height-correlated Smith visibility (Heitz 2014) and Schlick's Fresnel term; times pi,
// because a light of intensity 1 gives a white diffuse surface a radiance of 1.
vec3 reflect_light(vec3 n, vec3 v, vec3 l, float roughness, float reflectance) {
  vec3 h = normalize(l + v);
  float nl = max(dot(n, l), 0.0), nv = max(dot(n, v), 1e-3), nh = max(dot(n, h), 0.0);
  float a2 = roughness * roughness * roughness * roughness;
  float q = nh * nh * (a2 - 1.0) + 1.0;
  float d = a2 / (pi * q * q);
  float g =
      0.5 / max(nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2), 1e-5);
  float f = reflectance + (1.0 - reflectance) * pow(1.0 - max(dot(v, h), 0.0), 5.0);
  return vec3(pi * d * g * f * nl);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, ivec2(frame.size.xy)))) return;
  float depth = texelFetch(depth_image, pixel, 0).r;
  vec3 lighting = vec3(0.0), specular = vec3(0.0), back_lighting = vec3(0.0);
  float thickness = 0.0, maximum = 0.0;
  if (depth != frame.misc.x) {
    vec3 p = view_position(vec2(pixel) + 0.5, depth);
    vec3 v = frame.misc.w > 0.0 ? vec3(0.0, 0.0, 1.0) : normalize(-p);
    vec3 n = normalize(texelFetch(normal_image, pixel, 0).xyz);
    vec3 s = normalize(texelFetch(shading_image, pixel, 0).xyz);
    vec4 finish = texelFetch(finish_image, pixel, 0);

    vec3 around = mix(frame.ground.rgb, frame.sky.rgb, 0.5 + 0.5 * dot(s, frame.up.xyz));
    vec3 bounced =
        mix(frame.ground.rgb, frame.sky.rgb, 0.5 + 0.5 * dot(reflect(-v, s), frame.up.xyz));
    float rim = pow(1.0 - max(dot(s, v), 0.0), 5.0);
    lighting = around * finish.z;
    specular = bounced * finish.z * mix(finish.y, 1.0, rim * (1.0 - finish.x));
    for (uint i = 0u; i < frame.counts.x; ++i) {
      Light light = frame.lights[i];
      uint type = uint(light.position.w);
      vec3 l = type == light_directional ? -light.direction.xyz : light.position.xyz - p;
      float falloff = 1.0;
      if (type != light_directional) {
        falloff = 1.0 / max(dot(l, l), 1e-6);
        l *= inversesqrt(max(dot(l, l), 1e-12));
      }
      if (type == light_spot)
        falloff *= smoothstep(light.direction.w, light.intensity.w, -dot(l, light.direction.xyz));
      float behind = -dot(n, l);
      // Keeps the light from behind with the most transmission.
      if (falloff > 0.0 && behind > 0.0) {
        // Metres; only ranks lights, because the graph's profile decides the transmission.
        const float reach = 0.005;
        float way = way_through(light, p, l);
        vec3 arriving = light.intensity.rgb * falloff * behind;
        float through = dot(arriving, vec3(0.2126, 0.7152, 0.0722)) * exp(-way / reach);
        if (way >= 0.0 && through > maximum) {
          maximum = through;
          thickness = way;
          back_lighting = arriving;
        }
      }
      if (falloff <= 0.0 || dot(s, l) <= 0.0 || dot(n, l) <= 0.0) continue;
      // bumps must not be lit from behind the surface
      vec3 arriving = light.intensity.rgb * falloff * visibility(light, p, n, l) *
                      smoothstep(0.0, 0.1, dot(n, l));
      lighting += arriving * dot(s, l);
      specular += arriving * reflect_light(s, v, l, finish.x, finish.y) * mix(0.3, 1.0, finish.z);
    }
  }
  imageStore(lighting_image, pixel, vec4(min(lighting, vec3(60000.0)), 1.0));
  imageStore(specular_image, pixel, vec4(min(specular, vec3(60000.0)), 1.0));
  imageStore(thickness_image, pixel, vec4(thickness, 0.0, 0.0, 1.0));
  imageStore(back_lighting_image, pixel, vec4(min(back_lighting, vec3(60000.0)), 1.0));
}
