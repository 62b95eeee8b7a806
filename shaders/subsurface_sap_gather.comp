#version 460
// The last step up: scattered light of every listed pixel.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_gather.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
#include "radius.glsl"
#include "sap_gather.glsl"

void main() { gather_block(); }
