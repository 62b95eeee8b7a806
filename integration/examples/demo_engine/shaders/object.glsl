// Placement of one object, in push constants; mirrors render/frame_data.hpp.
layout(push_constant) uniform Object {
  vec4 world[3];    // rows of world_from_object
  vec4 previous[3]; // rows of the last frame's world_from_object
  uint material;    // gbuffer: index of the material; shadow: unused
  uint layer;       // shadow: index of shadow_from_world
} object;

vec3 to_world(vec3 p) {
  return vec3(dot(object.world[0], vec4(p, 1.0)), dot(object.world[1], vec4(p, 1.0)),
              dot(object.world[2], vec4(p, 1.0)));
}

vec3 to_previous_world(vec3 p) {
  return vec3(dot(object.previous[0], vec4(p, 1.0)), dot(object.previous[1], vec4(p, 1.0)),
              dot(object.previous[2], vec4(p, 1.0)));
}

// Transforms normals by the cofactors of the linear part, for scales that differ between axes.
vec3 normal_to_world(vec3 n) {
  mat3 m = mat3(object.world[0].xyz, object.world[1].xyz, object.world[2].xyz); // columns = rows
  return vec3(dot(cross(m[1], m[2]), n), dot(cross(m[2], m[0]), n), dot(cross(m[0], m[1]), n));
}
