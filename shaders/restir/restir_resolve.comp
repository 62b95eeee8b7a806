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

// The host's scene; this kernel shifts no path and needs no rays and lights.
ray_instance instance_at(uint index) { return instances_data[index]; }
uint index_at(uint index) { return indices_data[index]; }
vec4 vertex_at(uint index) { return vertices_data[index]; }

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  if (id == 0u)
    return;
  scatter_domain domain = domain_of(material_image, depth_image, normal_image, scatter_scale_image,
                                    has_scatter_scale(), pixel);
  packed_reservoir packed;
  for (uint i = 0u; i < 4u; ++i)
    packed.words[i] = reservoirs_data[4u * element_of(pixel) + i];
  // Traced light contains no albedo, because the albedo at x2 is unknown.
  vec3 came = resolve(domain, unpack_reservoir(packed));
  if (settings.texturing != TEXTURING_DEMODULATE)
    came = texture_light(albedo_image, has_albedo(), settings.texturing, texel, came);
  vec3 direct = mix(vec3(1.0), profile_direct(id), greaterThan(domain.d, vec3(0.0)));
  vec3 own = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing, texel);
  vec3 light = mix(came, own, direct);
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
