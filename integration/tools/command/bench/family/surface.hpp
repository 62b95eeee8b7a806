#pragma once
// A scene of the family as functions of position, and the functions that make such scenes.

#include "integration/tools/command/bench/pattern.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace dermis::tools {

inline constexpr double radians_per_degree = 3.14159265358979323846 / 180;

struct PixelIndex {
  uint32_t x = 0, y = 0;
};

// A sheet of a surface. Lengths are mean pixel sides; a Place is measured from the centre of the
// upper left pixel, before perspective.
struct FamilyLayer {
  std::function<double(Place)> rise;       // towards the viewer
  std::function<double(Place)> gain = {};  // factor of the scene's pattern; empty: 1
  std::function<double(Place)> light = {}; // replaces the pattern
};

struct FamilySurface {
  static constexpr int background = -1;

  std::vector<FamilyLayer> layers;
  // Returns the visible layer or `background`. Empty: the first layer.
  std::function<int(PixelIndex, Place)> visible = {};
  // Returns the profile id, 1 or 2. Empty: 1.
  std::function<uint8_t(PixelIndex, Place)> material = {};
};

// Parameters of a surface.
struct FamilyValues {
  std::array<double, 4> value{}; // parameters of the kind
  uint32_t seed = 0;             // of patterns
  double d_px = 1;
  Place size; // of the picture

  double operator[](size_t i) const { return value[i]; }
  double random(uint32_t i, uint32_t j = 0) const { return double(hashed(i + 131 * seed, j)); }
};

// Returns bands of two brightnesses, `width` wide along x.
double bands(double x, double width);

// Smooth surfaces.
FamilySurface make_plane(const FamilyValues& v);
FamilySurface make_bands(const FamilyValues& v);     // width
FamilySurface make_tilt(const FamilyValues& v);      // angle and direction, degrees
FamilySurface make_bumps(const FamilyValues& v);     // period, angle
FamilySurface make_egg_crate(const FamilyValues& v); // period, angle
FamilySurface make_sphere(const FamilyValues& v);    // radius as a fraction of the height
FamilySurface make_cylinders(const FamilyValues& v); // radius, gap
FamilySurface make_noise(const FamilyValues& v);     // standard deviation of the rise
FamilySurface make_fractal(const FamilyValues& v);   // height, largest cell

// Surfaces with folds and steps.
FamilySurface make_zigzag(const FamilyValues& v);  // angle, period, direction
FamilySurface make_grooves(const FamilyValues& v); // width, depth, spacing, light inside
FamilySurface make_wave(const FamilyValues& v);    // period, angle, direction
FamilySurface make_step(const FamilyValues& v);    // height, light below
FamilySurface make_stairs(const FamilyValues& v);  // tread, height, light of every second tread
FamilySurface make_plates(const FamilyValues& v);  // width, height
FamilySurface make_scales(const FamilyValues& v);  // width, angle

// Materials side by side, and surfaces with gaps.
FamilySurface make_checker(const FamilyValues& v);          // cell
FamilySurface make_stripes(const FamilyValues& v);          // width
FamilySurface make_random_materials(const FamilyValues& v); // cell
FamilySurface make_strips(const FamilyValues& v);           // width, gap
FamilySurface make_mask(const FamilyValues& v);             // cell

// Surfaces in front of others.
FamilySurface make_screen_door(const FamilyValues& v);    // distance: every second row and column
FamilySurface make_checker_dither(const FamilyValues& v); // distance
FamilySurface make_noise_dither(const FamilyValues& v);   // distance, fraction in front
FamilySurface make_hair(const FamilyValues& v);           // width, spacing, distance, light
FamilySurface make_strands(const FamilyValues& v);        // width, number, largest distance
FamilySurface make_holes(const FamilyValues& v);          // radius, spacing, depth; 0: background
FamilySurface make_bars(const FamilyValues& v);           // width, gap: round bars, no ground
FamilySurface make_ridges(const FamilyValues& v);         // width, spacing, height

} // namespace dermis::tools
