// Lights and next-event estimation. tests/passes/restir/cpu/lights.cpp mirrors and documents these
// functions in fp64 under the same names.
#ifndef DERMIS_RESTIR_LIGHTS_GLSL
#define DERMIS_RESTIR_LIGHTS_GLSL

// 64 bytes in std430.
struct light_source {
  vec3 position; // point: position; area: a corner; directional: unit vector towards the light
  uint type;
  vec3 edge_u; // area: edges; the light emits towards cross(edge_u, edge_v)
  float fraction; // probability of selection
  vec3 edge_v;
  float area;    // area: its area; directional: length of its shadow rays; point: 1
  vec3 emission; // point: intensity; area: radiance; directional: irradiance
  float until;   // sum of `fraction` up to and including this light
};

const uint light_point = 0u, light_parallelogram = 1u, light_triangle = 2u, light_directional = 3u;

bool light_has_area(light_source light) {
  return light.type == light_parallelogram || light.type == light_triangle;
}

// Packs two coordinates on a light in 16 bits each.
uint light_place(float u, float v) {
  uvec2 cell = min(uvec2(max(vec2(u, v), vec2(0.0)) * 65536.0), uvec2(65535u));
  return cell.x | cell.y << 16;
}

// Returns the density of selecting this light and a place on it, per unit area for area lights.
float light_density(light_source light) {
  return light_has_area(light) ? light.fraction / light.area : light.fraction;
}

// Returns the end of shadow rays from `from`.
vec3 light_target(light_source light, uint place, vec3 from) {
  if (light.type == light_point)
    return light.position;
  if (light.type == light_directional)
    return from + light.area * light.position;
  vec2 uv = (vec2(place & 0xffffu, place >> 16) + 0.5) / 65536.0;
  if (light.type == light_triangle && uv.x + uv.y > 1.0)
    uv = 1.0 - uv;
  return light.position + uv.x * light.edge_u + uv.y * light.edge_v;
}

// Returns the unoccluded irradiance at a surface from this place of the light, per unit area for
// area lights.
vec3 light_irradiance(light_source light, uint place, vec3 position, vec3 normal, vec3 shading) {
  vec3 way = light_target(light, place, position) - position;
  float square = dot(way, way);
  if (!(square > 0.0))
    return vec3(0.0);
  vec3 direction = way * inversesqrt(square);
  float cosine = dot(direction, shading);
  if (!(cosine > 0.0) || !(dot(direction, normal) > 0.0))
    return vec3(0.0);
  if (light.type == light_directional)
    return cosine * light.emission;
  float factor = cosine / square;
  if (light_has_area(light)) {
    float leaving = -dot(direction, normalize(cross(light.edge_u, light.edge_v)));
    if (!(leaving > 0.0))
      return vec3(0.0);
    factor *= leaving;
  }
  return factor * light.emission;
}

#endif
