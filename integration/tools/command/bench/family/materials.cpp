// Planes of the family with two materials side by side, and planes with gaps.

#include "integration/tools/command/bench/family/surface.hpp"

#include <cmath>

namespace dermis::tools {
namespace {

FamilySurface plane_of(std::function<uint8_t(PixelIndex, Place)> material) {
  return {.layers = {{[](Place) { return 0.0; }}}, .visible = {}, .material = std::move(material)};
}

FamilySurface plane_with_gaps(std::function<bool(PixelIndex)> gap) {
  FamilySurface surface = plane_of({});
  surface.visible = [gap = std::move(gap)](PixelIndex at, Place) {
    return gap(at) ? FamilySurface::background : 0;
  };
  return surface;
}

uint32_t whole(double value) {
  return static_cast<uint32_t>(std::max(1.0, std::round(value)));
}

uint8_t id_of(bool second) {
  return second ? 2 : 1;
}

} // namespace

FamilySurface make_checker(const FamilyValues& v) {
  const uint32_t cell = whole(v[0]);
  return plane_of(
      [=](PixelIndex at, Place) { return id_of((at.x / cell + at.y / cell) % 2 != 0); });
}

FamilySurface make_stripes(const FamilyValues& v) {
  const uint32_t width = whole(v[0]);
  return plane_of([=](PixelIndex at, Place) { return id_of(at.x / width % 2 != 0); });
}

FamilySurface make_random_materials(const FamilyValues& v) {
  const uint32_t cell = whole(v[0]);
  return plane_of([=](PixelIndex at, Place) {
    return id_of(v.random(at.x / cell + 11, at.y / cell + 5) < 0.5);
  });
}

FamilySurface make_strips(const FamilyValues& v) {
  const uint32_t width = whole(v[0]), spacing = width + whole(v[1]);
  return plane_with_gaps([=](PixelIndex at) { return at.x % spacing >= width; });
}

FamilySurface make_mask(const FamilyValues& v) {
  const uint32_t cell = whole(v[0]);
  return plane_with_gaps([=](PixelIndex at) { return (at.x / cell + at.y / cell) % 2 != 0; });
}

} // namespace dermis::tools
