#version 460
// The last step up, from two layers a texel: scattered light of every listed pixel.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_gather_layered.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
#include "radius.glsl"
#define SAP_COARSE_LAYERS 2
#include "sap_gather.glsl"

void main() { gather_block(); }
