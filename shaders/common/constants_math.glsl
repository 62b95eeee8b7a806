// Constants of mathematics, units and colour.
#ifndef DERMIS_CONSTANTS_MATH_GLSL
#define DERMIS_CONSTANTS_MATH_GLSL

const float two_pi = 6.28318530717958648;
const float golden_angle = 2.39996322972865332; // pi (3 - sqrt 5)
const float mm_per_metre = 1000.0;
const vec3 luminance_weights = vec3(0.2126, 0.7152, 0.0722); // of linear RGB, Rec. 709

#endif
