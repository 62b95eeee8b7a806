// One object of the host's scene, as stored in the port `instances`.
#ifndef DERMIS_RESTIR_INSTANCES_GLSL
#define DERMIS_RESTIR_INSTANCES_GLSL

struct ray_instance {
  vec4 world_from_object[3]; // rows
  uvec4 place;               // first vertex, first index, profile id, 0
};

#endif
