#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform sampler2D lighting_image;
layout(set = 0, binding = 3) uniform sampler2D specular_image;
layout(set = 0, binding = 4) uniform sampler2D albedo_image;
layout(set = 0, binding = 5) uniform usampler2D material_image;
layout(set = 0, binding = 6) uniform sampler2D finish_image;
layout(set = 0, binding = 7) uniform sampler2D scattered_image;
layout(set = 0, binding = 8, rgba32f) uniform writeonly image2D color_image;

// Storage of scattered light: counts.y.
const uint scattering_none = 0u;     // no scattering: light times albedo everywhere
// lighting holds scattered light times albedo in pixels with a profile
const uint scattering_in_place = 1u;
const uint scattering_apart = 2u;    // scattered_image holds scattered light, before albedo

const float largest_emission = 16.0; // as in gbuffer.frag

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, ivec2(frame.size.xy)))) return;
  vec3 color = frame.background.rgb;
  if (texelFetch(depth_image, pixel, 0).r != frame.misc.x) {
    vec3 albedo = texelFetch(albedo_image, pixel, 0).rgb;
    vec3 diffuse = texelFetch(lighting_image, pixel, 0).rgb;
    bool scatters = texelFetch(material_image, pixel, 0).r != 0u;
    if (scatters && frame.counts.y == scattering_apart)
      diffuse = texelFetch(scattered_image, pixel, 0).rgb;
    if (!scatters || frame.counts.y != scattering_in_place) diffuse *= albedo;
    color = diffuse + texelFetch(specular_image, pixel, 0).rgb +
            albedo * texelFetch(finish_image, pixel, 0).a * largest_emission;
  }
  imageStore(color_image, pixel, vec4(color * frame.misc.y, 1.0));
}
