#version 460
// Copies the steps of samples of tiles, the list of tiles with samples and its arguments to an
// image.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = 0) readonly buffer b0 { uint samples_per_tile[]; };
layout(std430, set = 0, binding = 1) readonly buffer b1 { uint tiles[]; };
layout(std430, set = 0, binding = 2) readonly buffer b2 { uint arguments[]; };
layout(set = 0, binding = 3) uniform writeonly uimage2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = imageSize(target);
  if (any(greaterThanEqual(at, size)))
    return;
  int i = at.y * size.x + at.x;
  uvec4 value = uvec4(0u);
  value.x = i < samples_per_tile.length() ? samples_per_tile[i] : 0u;
  value.y = i < tiles.length() ? tiles[i] : 0u;
  value.z = i < 3 ? arguments[i] : 0u;
  imageStore(target, at, value);
}
