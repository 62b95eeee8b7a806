// Rounding to fp16 in the shader: drivers may truncate in imageStore, which would darken every
// pass.
#ifndef DERMIS_HALF_GLSL
#define DERMIS_HALF_GLSL

const float largest_half = 65504.0;

// Returns the fp16 value nearest to x (ties to even) as fp32, so that a store is exact for any
// rounding mode.
float round_to_half(float x) {
  float a = clamp(x, -largest_half, largest_half);
  // The shift is 1.5 * 2^(e + 13) for x from 2^e to 2^(e + 1). Its last bit is worth 2^(e - 10), as
  // the last bit of the half, so that the addition rounds correctly. Below 2^-14, halves are
  // multiples of 2^-24.
  uint exponent = max(floatBitsToUint(a) & 0x7f800000u, 0x38800000u);
  float shift = uintBitsToFloat(exponent + 0x06c00000u);
  precise float sum = a + shift;
  precise float rounded = sum - shift;
  return rounded;
}
vec3 round_to_half(vec3 v) {
  return vec3(round_to_half(v.x), round_to_half(v.y), round_to_half(v.z));
}
vec4 round_to_half(vec4 v) { return vec4(round_to_half(v.xyz), round_to_half(v.w)); }

#endif
