// Ray queries through the host's scene from compute kernels.
#ifndef DERMIS_RESTIR_RAYS_GLSL
#define DERMIS_RESTIR_RAYS_GLSL

#extension GL_EXT_ray_query : require

#include "restir/surfaces.glsl"

const uint ray_any = 0xffu; // instance mask that accepts all instances

// As trace_probe of scene.glsl, through an acceleration structure.
void trace_probe(accelerationStructureEXT scene, probe_ray ray, uint medium, out probe_hits hits) {
  hits.count = 0u;
  if (!(ray.reach > 0.0))
    return;
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene, gl_RayFlagsNoOpaqueEXT, ray_any, ray.origin, 0.0,
                        ray.direction, ray.reach);
  // No intersection is confirmed, so every triangle is a candidate.
  while (rayQueryProceedEXT(query)) {
    probe_hit met;
    met.instance = uint(rayQueryGetIntersectionInstanceCustomIndexEXT(query, false));
    if (instance_at(met.instance).place.z != medium)
      continue;
    met.primitive = uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false));
    met.barycentrics = rayQueryGetIntersectionBarycentricsEXT(query, false);
    met.distance = rayQueryGetIntersectionTEXT(query, false);
    uint at = min(hits.count, max_probe_hits - 1u);
    if (hits.count == max_probe_hits && met.distance >= hits.hit[at].distance)
      continue;
    for (; at > 0u && hits.hit[at - 1u].distance > met.distance; --at)
      hits.hit[at] = hits.hit[at - 1u];
    hits.hit[at] = met;
    hits.count = min(hits.count + 1u, max_probe_hits);
  }
}

// Offset of a ray's origin above the surface, relative to 1 plus the distance to the world's
// origin: a few rounding errors of a position's coordinates.
const float ray_lift = 2e-5;

// As visible of scene.glsl, through an acceleration structure.
bool visible(accelerationStructureEXT scene, surface_point from, vec3 target) {
  float size = 1.0 + max(abs(from.position.x), max(abs(from.position.y), abs(from.position.z)));
  vec3 origin = from.position + ray_lift * size * from.normal;
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene, gl_RayFlagsOpaqueEXT | gl_RayFlagsTerminateOnFirstHitEXT,
                        ray_any, origin, 0.0, target - origin, 1.0 - ray_lift);
  while (rayQueryProceedEXT(query))
    ;
  return rayQueryGetIntersectionTypeEXT(query, true) == gl_RayQueryCommittedIntersectionNoneEXT;
}

#endif
