// The interface to a scene. GLSL cannot pass a scene's buffers to functions, so this file declares
// functions that read the scene, and a kernel defines the functions that it uses.
// tests/passes/restir/cpu/scene.hpp is the CPU version.
#ifndef DERMIS_RESTIR_SCENE_GLSL
#define DERMIS_RESTIR_SCENE_GLSL

#include "restir/lights.glsl"
#include "restir/probe.glsl"

struct surface_point {
  vec3 position;
  vec3 normal;  // geometric normal, unit length, outwards: densities are per area of this surface
  vec3 shading; // shading normal, unit length: gives the cosine of incident light
  uint medium;
};

// Returns one of the hits with surfaces of the medium, front and back, of which the nearest
// max_probe_hits count.
chosen_hit trace_probe(probe_ray ray, uint medium, hit_choice choice);
surface_point surface_at(uint instance, uint primitive, vec2 barycentrics);
// Returns whether the segment from the surface (with the ray's origin lifted off it) to the target
// is free.
bool visible(surface_point from, vec3 target);
uint light_count();
light_source light_at(uint index);
// Returns the same light in the previous frame.
light_source previous_light_at(uint index);

// Returns the first light whose `until` is above u; the last light if none is.
uint pick_light(float u) {
  uint i = 0u, count = light_count();
  while (i + 1u < count && !(u < light_at(i).until))
    ++i;
  return i;
}

#endif
