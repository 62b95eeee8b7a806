#version 460
// One ray query and nothing else, with the ports of restir.initial. check_kernels.sh compiles this
// kernel instead of restir_initial.comp: kernels with ray queries may use little more scratch
// memory.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_ray_query : require
#include "restir/instances.glsl"
#include "restir/lights.glsl"
#include "restir/restir_initial.bindings.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

void main() {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, scene_structure, gl_RayFlagsOpaqueEXT, 0xffu,
                        vec3(gl_GlobalInvocationID), 0.0, vec3(0.0, 0.0, 1.0), 1.0);
  while (rayQueryProceedEXT(query))
    ;
  float distance = rayQueryGetIntersectionTEXT(query, true);
  reservoirs_data[gl_GlobalInvocationID.x] = uvec4(floatBitsToUint(distance));
}
