#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "noise.glsl"
#include "object.glsl"

const uint pattern_plain = 0u;
const uint pattern_skin = 1u;
const uint pattern_jade = 2u;
const uint pattern_wax = 3u;
const uint pattern_plaster = 4u;
const uint pattern_checker = 5u;

struct Material {
  vec4 albedo; // linear; w = roughness
  // x = reflectance at normal incidence, y = emission (times albedo), z = normal map strength
  vec4 finish;
  uvec4 kind;  // x = profile id, y = pattern
};
layout(set = 0, binding = 1, std430) readonly buffer Materials { Material materials[]; };
layout(set = 1, binding = 0) uniform sampler2D albedo_map;
layout(set = 1, binding = 1) uniform sampler2D normal_map;
layout(set = 1, binding = 2) uniform sampler2D specular_map;

layout(location = 0) in vec3 object_position;
layout(location = 1) in vec3 world_normal;
layout(location = 2) in vec4 world_tangent;
layout(location = 3) in vec2 texture_uv;
layout(location = 4) in vec3 surface_tint;
layout(location = 5) in vec2 surface_finish;
layout(location = 6) in vec3 clip_now;
layout(location = 7) in vec3 clip_previous;

layout(location = 0) out vec4 out_normal;  // view space, geometric
layout(location = 1) out vec4 out_shading; // view space, with normal map
layout(location = 2) out vec4 out_albedo;
layout(location = 3) out uint out_material;
// roughness, reflectance, openness, emission / largest_emission
layout(location = 4) out vec4 out_finish;
layout(location = 5) out vec2 out_velocity;

const float largest_emission = 16.0;

// Applies colour and bumps by place. Lengths are those of the real material (metres); strengths are
// chosen by eye.
void paint(uint pattern, vec3 p, inout vec3 albedo, inout float roughness, inout float reflectance,
           out vec3 bump) {
  bump = vec3(0.0);
  if (pattern == pattern_skin) {
    vec3 broad = noise3(p * 90.0), fine = noise3(p * 420.0 + 7.0);
    albedo *= mix(vec3(0.93, 0.90, 0.88), vec3(1.05, 1.06, 1.07), 0.6 * broad.x + 0.4 * fine.x);
    vec2 spot = speckle(p * 230.0);
    float freckle =
        smoothstep(0.34, 0.10, spot.x) * step(0.45, spot.y) * smoothstep(0.45, 0.65, broad.y);
    albedo *= mix(vec3(1.0), vec3(0.78, 0.64, 0.54), 0.7 * freckle);
    bump = (fine - 0.5) * 0.13 + (noise3(p * 900.0) - 0.5) * 0.12;
    roughness *= 0.9 + 0.25 * fine.z;
  } else if (pattern == pattern_jade) {
    vec3 warp = noise3(p * 28.0);
    float vein = noise3(p * 45.0 + 2.2 * warp).x;
    albedo *= mix(vec3(0.62, 0.86, 0.72), vec3(1.15, 1.06, 1.02), smoothstep(0.25, 0.75, vein));
  } else if (pattern == pattern_wax) {
    vec3 broad = noise3(p * 60.0);
    albedo *= 0.96 + 0.06 * broad.x;
    bump = (broad - 0.5) * 0.10;
  } else if (pattern == pattern_plaster) {
    vec3 broad = noise3(p * 7.0), fine = noise3(p * 60.0);
    albedo *= 0.85 + 0.2 * broad.x + 0.1 * fine.x;
    bump = (fine - 0.5) * 0.06;
  } else if (pattern == pattern_checker) {
    ivec2 field = ivec2(floor(p.xz * 10.0));
    albedo *= ((field.x + field.y) & 1) == 0 ? 1.0 : 0.6;
  }
}

void main() {
  Material material = materials[object.material];
  mat3 view = mat3(frame.view_from_world);
  vec3 n = normalize(world_normal);
  // Back faces show the other side of a sheet; interpolated normals may point slightly away at a
  // silhouette.
  vec3 to_viewer =
      frame.misc.w > 0.0 ? vec3(0.0, 0.0, 1.0) : -view_position(gl_FragCoord.xy, gl_FragCoord.z);
  if (dot(view * n, normalize(to_viewer)) < -0.2) n = -n;
  vec3 t = world_tangent.xyz - n * dot(n, world_tangent.xyz);
  t = dot(t, t) > 0.0 ? normalize(t) : vec3(0.0);
  vec3 b = cross(n, t) * world_tangent.w;
  vec3 mapped = texture(normal_map, texture_uv).xyz * 2.0 - 1.0;
  mapped.xy *= material.finish.z;

  vec3 albedo = material.albedo.rgb * surface_tint * texture(albedo_map, texture_uv).rgb;
  float roughness = material.albedo.w;
  float reflectance = material.finish.x * surface_finish.y * texture(specular_map, texture_uv).r;
  vec3 bump;
  paint(material.kind.y, object_position, albedo, roughness, reflectance, bump);

  vec3 shading = normalize(t * mapped.x + b * mapped.y + n * max(mapped.z, 0.1));
  bump = normal_to_world(bump) / max(length(normal_to_world(vec3(1.0)) / sqrt(3.0)), 1e-20);
  shading = normalize(shading + bump - n * dot(bump, n));
  out_normal = vec4(view * n, 0.0);
  out_shading = vec4(view * shading, 0.0);
  out_albedo = vec4(clamp(albedo, 0.0, 1.0), 1.0);
  out_material = material.kind.x;
  out_finish = vec4(clamp(roughness, 0.05, 1.0), reflectance, surface_finish.x,
                    material.finish.y / largest_emission);
  out_velocity =
      (clip_now.xy / clip_now.z - clip_previous.xy / clip_previous.z) * 0.5 * frame.size.xy;
}
