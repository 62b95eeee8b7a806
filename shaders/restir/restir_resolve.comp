#version 460
// Writes the light of each pixel's path; where light does not scatter, the pixel's own light.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "restir/instances.glsl"
#include "restir/restir_resolve.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "common/pixel_light.glsl"

#include "restir/surfaces.glsl"
#include "restir/reuse.glsl"

uint light_count() { return 0u; } // unused definitions: this kernel shifts no path
light_source light_at(uint index) { return light_source(vec3(0.0), 0u, vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(0.0), 0.0); }
bool visible(surface_point from, vec3 target) { return false; }
void trace_probe(probe_ray ray, uint medium, out probe_hits hits) { hits.count = 0u; }

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = texelFetch(material_image, texel, 0).r;
  if (id == 0u)
    return;
  scatter_domain domain = domain_of(pixel);
  packed_reservoir packed;
  for (uint i = 0u; i < 4u; ++i)
    packed.words[i] = reservoirs_data[4u * element_of(pixel) + i];
  // Traced light contains no albedo, because the albedo at x2 is unknown.
  vec3 came = resolve(domain, unpack_reservoir(packed));
  if (settings.texturing != TEXTURING_DEMODULATE)
    came = texture_light(texel, came);
  vec3 direct = mix(vec3(1.0), profile_direct(id), greaterThan(domain.d, vec3(0.0)));
  vec3 light = mix(came, pixel_light(texel), direct);
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
