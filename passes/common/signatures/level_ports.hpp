#pragma once
// Ports of other pass types that read a level of the surface-aware pyramid.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface::port {

inline constexpr Format surface_formats[] = {Format::rgba32_uint};
inline constexpr std::string_view level_image_doc = "output of subsurface.sap_down";

constexpr Port level_light(std::string_view name) {
  return {name, Usage::sampled_image, false, "texture2D", level_image_doc, light_formats};
}
constexpr Port level_surface(std::string_view name) {
  return {name, Usage::sampled_image, false, "utexture2D", level_image_doc, surface_formats};
}

} // namespace dermis::subsurface::port
