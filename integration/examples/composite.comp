#version 460
#extension GL_EXT_samplerless_texture_functions : require
// A host's pass after Dermis: applies albedo and adds specular light. `lighting` is the image that
// was bound to Dermis. If `dermis_applied_albedo` is 1 (`albedo` was bound and the setting `result`
// is "color"), pixels with a profile already contain albedo. See docs/integration.md, "After
// Dermis".
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform texture2D lighting;
layout(set = 0, binding = 1) uniform utexture2D material;
layout(set = 0, binding = 2) uniform texture2D albedo;
layout(set = 0, binding = 3) uniform texture2D specular;
layout(set = 0, binding = 4) uniform writeonly image2D shown;
layout(push_constant) uniform Settings { int dermis_applied_albedo; } settings;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(shown)))) return;
  vec3 light = texelFetch(lighting, pixel, 0).rgb;
  bool subsurface = texelFetch(material, pixel, 0).r != 0u;
  if (!(subsurface && settings.dermis_applied_albedo != 0))
    light *= texelFetch(albedo, pixel, 0).rgb;
  imageStore(shown, pixel, vec4(light + texelFetch(specular, pixel, 0).rgb, 1.0));
}
