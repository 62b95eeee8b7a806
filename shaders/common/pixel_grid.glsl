// The plan for pixels that are not square; mirrors framegraph/model/pixel_grid.hpp.
#ifndef DERMIS_PIXEL_GRID_GLSL
#define DERMIS_PIXEL_GRID_GLSL

layout(constant_id = 4) const uint pixel_grid = 0u;
const bool square_pixels = pixel_grid == 0u;
const uint grid_of_pixels = square_pixels ? 1u : pixel_grid;
const int pixel_doublings = int((grid_of_pixels - 1u) >> 1u);
const bool higher_pixels = (grid_of_pixels & 1u) == 0u;
// Number of the first levels of a pyramid that do not halve an axis: that of the longer sides.
const int kept_x = higher_pixels ? 0 : pixel_doublings;
const int kept_y = higher_pixels ? pixel_doublings : 0;

// Returns how often a level of a pyramid halves the axes, and whether (1 or 2) the step from a
// level to the next coarser one halves them.
ivec2 halvings_of_level(int level) {
  return square_pixels ? ivec2(level) : max(level - ivec2(kept_x, kept_y), 0);
}
ivec2 step_from_level(int level) {
  return square_pixels ? ivec2(2)
                       : ivec2(level < kept_x ? 1 : 2, level < kept_y ? 1 : 2);
}

#endif
