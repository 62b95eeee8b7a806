#version 460
// The last step up: writes the scattered light of every listed pixel, from the nearer layers of
// level 1.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_gather.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/radius.glsl"
#define SAP_COARSE_LAYERS 2
#include "sap/sap_gather.glsl"

void main() { gather_block(); }
