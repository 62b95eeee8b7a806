// What is asked of a scene. The kernel that includes this defines the five functions at the end, over its acceleration
// structure and buffers; tests/passes/restir/cpu/scene.hpp is the same for the CPU.
#ifndef DERMIS_RESTIR_SCENE_GLSL
#define DERMIS_RESTIR_SCENE_GLSL

#include "restir/lights.glsl"
#include "restir/probe.glsl"

struct surface_point {
  vec3 position;
  vec3 normal;  // geometric, unit length, outwards: densities are per area of it
  vec3 shading; // unit length: light falls in by it
  uint medium;
};

// All hits with surfaces of the medium, front and back, in order of distance; the nearest max_probe_hits. A ray query
// meets candidates in any order: sort them.
void trace_probe(probe_ray ray, uint medium, out probe_hits hits);
surface_point surface_at(uint instance, uint primitive, vec2 barycentrics);
// Is the way from the surface (off which the ray is lifted) to the target free?
bool visible(surface_point from, vec3 target);
uint light_count();
light_source light_at(uint index);

// The first light whose `until` lies above u; the last where none does.
uint pick_light(float u) {
  uint i = 0u, count = light_count();
  while (i + 1u < count && !(u < light_at(i).until))
    ++i;
  return i;
}

#endif
