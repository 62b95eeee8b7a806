// Rounding to fp16 in the shader: drivers may truncate in imageStore, which darkens every pass.
#ifndef DERMIS_HALF_GLSL
#define DERMIS_HALF_GLSL

const float largest_half = 65504.0;

// The fp16 value nearest to x (ties to even), as fp32, so that a store is exact whatever its rounding.
float round_to_half(float x) {
  float a = min(abs(x), largest_half);
  float subnormal = roundEven(a * 16777216.0) / 16777216.0; // below 2^-14 halves are multiples of 2^-24
  uint bits = floatBitsToUint(a);
  bits += 0xfffu + ((bits >> 13) & 1u);
  float normal = min(uintBitsToFloat(bits & 0xffffe000u), largest_half);
  return sign(x) * (a < 6.103515625e-5 ? subnormal : normal);
}
vec3 round_to_half(vec3 v) { return vec3(round_to_half(v.x), round_to_half(v.y), round_to_half(v.z)); }
vec4 round_to_half(vec4 v) { return vec4(round_to_half(v.xyz), round_to_half(v.w)); }

#endif
