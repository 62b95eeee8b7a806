#version 460
// Computes the next coarser level: [1 3 3 1] x [1 3 3 1] as four reads between texels, each with
// weights 1/4 and 3/4 per axis, or the mean of 2x2 texels as one read. An axis that the level does
// not halve is read at its texels.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "afis/subsurface_pyramid_down.bindings.glsl"
#include "common/environment.glsl"
#include "common/pixel_grid.glsl"
#include "common/half.glsl"
#include "afis/pyramid.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

// Returns the part of a read along an axis that is inside an image without a border: a read at its
// edge has a quarter of its weight outside, where the sampler repeats the edge.
float part_inside(float at, int size) { return at < 0.0 || at > float(size - 1) ? 0.75 : 1.0; }

vec4 read_fine(vec2 at, int border) {
  vec4 mean = pyramid_read(fine_image, at, border);
  ivec2 size = textureSize(fine_image, 0);
  return border > 0 ? mean : mean * part_inside(at.x, size.x) * part_inside(at.y, size.y);
}

void main() {
  ivec2 address = ivec2(gl_GlobalInvocationID.xy), size = imageSize(coarse_image);
  if (any(greaterThanEqual(address, size)))
    return;
  int fine_border = settings.borders == BORDERS_NONE ? 0 : pyramid_border;
  int coarse_border = settings.borders == BORDERS_BOTH ? pyramid_border : 0;
  bvec2 halves = greaterThan(step_from_level(settings.level - 1), ivec2(1));
  vec2 texel = vec2(address - coarse_border), apart = mix(vec2(0.0), vec2(0.75), halves);
  vec2 centre = mix(texel, 2.0 * texel + 0.5, halves); // in texels of the finer level
  vec4 mean;
  if (settings.halving == HALVING_BOX)
    mean = pyramid_read(fine_image, centre, fine_border);
  else
    mean = 0.25 * (read_fine(centre + vec2(-apart.x, -apart.y), fine_border) +
                   read_fine(centre + vec2(apart.x, -apart.y), fine_border) +
                   read_fine(centre + vec2(-apart.x, apart.y), fine_border) +
                   read_fine(centre + apart, fine_border));
  bool masked = settings.alpha == ALPHA_MASK;
  if (masked && spreads_mixed(mean.a))
    mean.a = mixed_mask;
  imageStore(coarse_image, address, masked ? round_masked_light(mean) : round_to_half(mean));
}
