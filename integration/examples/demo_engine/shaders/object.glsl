// One object's place, in push constants; mirrors render/frame_data.hpp.
layout(push_constant) uniform Object {
  vec4 world[3];    // rows of world_from_object
  vec4 previous[3]; // rows of last frame's
  uint material;    // gbuffer: into the materials; shadow: unused
  uint layer;       // shadow: which shadow_from_world
} object;

vec3 to_world(vec3 p) {
  return vec3(dot(object.world[0], vec4(p, 1.0)), dot(object.world[1], vec4(p, 1.0)),
              dot(object.world[2], vec4(p, 1.0)));
}

vec3 to_previous_world(vec3 p) {
  return vec3(dot(object.previous[0], vec4(p, 1.0)), dot(object.previous[1], vec4(p, 1.0)),
              dot(object.previous[2], vec4(p, 1.0)));
}

// For scales that may differ between axes: the cofactors of the linear part.
vec3 normal_to_world(vec3 n) {
  mat3 m = mat3(object.world[0].xyz, object.world[1].xyz, object.world[2].xyz); // columns = rows
  return vec3(dot(cross(m[1], m[2]), n), dot(cross(m[2], m[0]), n), dot(cross(m[0], m[1]), n));
}
