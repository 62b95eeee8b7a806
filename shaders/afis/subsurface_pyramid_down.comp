#version 460
// Computes the next coarser level: [1 3 3 1] x [1 3 3 1] as four reads between texels, each with
// weights 1/4 and 3/4 per axis, or the mean of 2x2 texels as one read.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "afis/subsurface_pyramid_down.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "afis/pyramid.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

void main() {
  ivec2 address = ivec2(gl_GlobalInvocationID.xy), size = imageSize(coarse_image);
  if (any(greaterThanEqual(address, size)))
    return;
  vec2 centre = 2.0 * vec2(address - pyramid_border) + 0.5; // in texels of the finer level
  vec4 mean;
  if (settings.halving == HALVING_BOX)
    mean = pyramid_read(fine_image, centre);
  else
    mean = 0.25 * (pyramid_read(fine_image, centre + vec2(-0.75, -0.75)) +
                   pyramid_read(fine_image, centre + vec2(0.75, -0.75)) +
                   pyramid_read(fine_image, centre + vec2(-0.75, 0.75)) +
                   pyramid_read(fine_image, centre + vec2(0.75, 0.75)));
  if (spreads_mixed(mean.a))
    mean.a = mixed_mask;
  imageStore(coarse_image, address, round_to_half(mean));
}
