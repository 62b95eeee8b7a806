#version 460
#extension GL_EXT_samplerless_texture_functions : require
// The host's own pass: light above a level becomes warmer.
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform texture2D light;
layout(set = 0, binding = 1, rgba16f) uniform writeonly image2D toned;
layout(push_constant) uniform Settings {
  ivec4 rect; // x, y, width, height of the rendered part
  float level;
} settings;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, settings.rect.zw))) return;
  pixel += settings.rect.xy;
  vec4 value = texelFetch(light, pixel, 0);
  float luminance = dot(value.rgb, vec3(0.2126, 0.7152, 0.0722));
  vec3 warm = value.rgb * vec3(1.0, 0.8, 0.6);
  imageStore(toned, pixel, vec4(luminance > settings.level ? warm : value.rgb, value.a));
}
