#version 460
// Copies the lists of tiles and their arguments to an image. The first row has the arguments.
#extension GL_GOOGLE_include_directive : require
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, set = 0, binding = 0) readonly buffer b0 { uvec2 level_tiles[]; };
layout(std430, set = 0, binding = 1) readonly buffer b1 { uint level_arguments[]; };
layout(std430, set = 0, binding = 2) readonly buffer b2 { uint tiles[]; };
layout(std430, set = 0, binding = 3) readonly buffer b3 { uint arguments[]; };
layout(std430, set = 0, binding = 4) readonly buffer b4 { uint copy_arguments[]; };
layout(std430, set = 0, binding = 5) readonly buffer b5 { uint plain_tiles[]; };
layout(std430, set = 0, binding = 6) readonly buffer b6 { uint plain_arguments[]; };
layout(set = 0, binding = 7) uniform writeonly uimage2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = imageSize(target);
  if (any(greaterThanEqual(at, size)))
    return;
  uvec4 value = uvec4(0u);
  if (at.y == 0) {
    value.x = at.x < level_arguments.length() ? level_arguments[at.x] : 0u;
    value.y = at.x < 3 ? arguments[at.x] : 0u;
    value.z = at.x < 3 && (port_mask & 16u) != 0u ? copy_arguments[at.x] : 0u;
    value.w = at.x < 3 ? plain_arguments[at.x] : 0u;
  } else {
    int i = (at.y - 1) * size.x + at.x;
    value.xy = i < level_tiles.length() ? level_tiles[i] : uvec2(0u);
    value.z = i < tiles.length() ? tiles[i] : 0u;
    value.w = i < plain_tiles.length() ? plain_tiles[i] : 0u;
  }
  imageStore(target, at, value);
}
