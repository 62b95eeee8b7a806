// Ray queries through the host's scene from compute kernels.
#ifndef DERMIS_RESTIR_RAYS_GLSL
#define DERMIS_RESTIR_RAYS_GLSL

#extension GL_EXT_ray_query : require

#include "restir/hits.glsl"
#include "restir/surfaces.glsl"

const uint ray_any = 0xffu; // instance mask that accepts all instances

// A kernel passes the same `query` to both functions, because some drivers reserve memory for the
// traversal of each variable.

// As trace_probe of scene.glsl, through an acceleration structure.
chosen_hit trace_probe(accelerationStructureEXT scene, rayQueryEXT query, probe_ray ray,
                       uint medium, hit_choice choice) {
  chosen_hit chosen = chosen_hit(0u, 0u, no_hit());
  if (!(ray.reach > 0.0))
    return chosen;
  hit_pass pass = first_pass();
  // The loop has no call in its condition, because Mesa 22.3 compiles such a loop wrongly.
  for (bool ended = false; !ended;) {
    rayQueryInitializeEXT(query, scene, gl_RayFlagsNoOpaqueEXT, ray_any, ray.origin, 0.0,
                          ray.direction, ray.reach);
    // No intersection is confirmed, so every triangle is a candidate.
    while (rayQueryProceedEXT(query)) {
      probe_hit met;
      met.instance = uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false));
      if (profile_of(instance_at(met.instance).place.z) != medium)
        continue;
      met.primitive = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
      met.barycentrics = rayQueryGetIntersectionBarycentricsEXT(query, false);
      met.distance = rayQueryGetIntersectionTEXT(query, false);
      add_hit(pass, met);
    }
    ended = choose_hit(pass, choice, chosen);
  }
  return chosen;
}

// Offset of a ray's origin above the surface, relative to a metre plus the distance to the world's
// origin: a few rounding errors of a position's coordinates.
const float ray_lift = 2e-5;

// As visible of scene.glsl, through an acceleration structure.
bool visible(accelerationStructureEXT scene, rayQueryEXT query, surface_point from, vec3 target) {
  float size = mm_per_metre / mm_per_world_unit() +
               max(abs(from.position.x), max(abs(from.position.y), abs(from.position.z)));
  vec3 origin = from.position + ray_lift * size * from.normal;
  rayQueryInitializeEXT(query, scene, gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT,
                        ray_any, origin, 0.0, target - origin, 1.0 - ray_lift);
  while (rayQueryProceedEXT(query))
    ;
  return rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT;
}

#endif
