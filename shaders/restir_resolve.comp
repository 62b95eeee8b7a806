#version 460
// Light that the kept path of each pixel brings.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "restir/instances.glsl"
#include "restir_resolve.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "half.glsl"

int reservoir_row() { return textureSize(depth_image, 0).x; }

#include "restir/surfaces.glsl"
#include "restir/reuse.glsl"

uint light_count() { return 0u; } // no path is shifted here
light_source light_at(uint index) { return light_source(vec3(0.0), 0u, vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(0.0), 0.0); }
bool visible(surface_point from, vec3 target) { return false; }
void trace_probe(probe_ray ray, uint medium, out probe_hits hits) { hits.count = 0u; }

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  if (texelFetch(material_image, texel, 0).r == 0u)
    return;
  packed_reservoir packed;
  for (uint i = 0u; i < 4u; ++i)
    packed.words[i] = reservoirs_data[reservoir_place(pixel) + i];
  vec3 light = resolve(domain_of(pixel), unpack_reservoir(packed));
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
