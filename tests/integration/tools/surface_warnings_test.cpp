// Tests the warnings about frames whose pixels are not square or whose surfaces are dithered.
#include "integration/tools/command/run/surface_warnings.hpp"

#include "integration/tools/command/bench/dynamic/sequence.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace {

using namespace dermis;
using namespace dermis::tools;

constexpr uint32_t width = 64, height = 48;
constexpr double pitch_m = 2e-4;

CapturedFrame seen(const std::function<double(uint32_t, uint32_t)>& depth) {
  CapturedFrame frame;
  frame.description.width = width;
  frame.description.height = height;
  frame.description.render = {0, 0, width, height};
  frame.rays.scale_x = pitch_m;
  frame.rays.scale_y = -pitch_m;
  frame.depth = Image::sized(width, height, 1);
  frame.profile.assign(size_t{width} * height, 1);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      frame.depth.values[size_t{y} * width + x] = static_cast<float>(depth(x, y));
  return frame;
}

std::vector<DiagnosticId> warnings(const CapturedFrame& frame) {
  Diagnostics diagnostics;
  warn_of_surfaces(frame, diagnostics);
  std::vector<DiagnosticId> ids;
  for (const Diagnostic& one : diagnostics.list)
    ids.push_back(one.id);
  return ids;
}

double plane(uint32_t, uint32_t) {
  return 0.5;
}
bool is_random(uint32_t x, uint32_t y) {
  return ((x * 7919u + y * 104729u + x * y * 31u) >> 3) % 2 == 0;
}

TEST(SurfaceWarnings, PixelsFarFromSquaresAreNamed) {
  const std::vector<DiagnosticId> expected = {DiagnosticId::pixels_not_square};
  for (const double aspect : {0.1, 0.16, 6.1, 12.0}) {
    CapturedFrame frame = seen(plane);
    frame.rays.scale_x *= aspect;
    EXPECT_EQ(warnings(frame), expected) << aspect;
    EXPECT_NEAR(pixel_aspect(frame.rays), std::max(aspect, 1 / aspect), 1e-12);
  }
  for (const double aspect : {1.0, 0.98, 2.0, 0.25, 5.9}) {
    CapturedFrame frame = seen(plane);
    frame.rays.scale_x *= aspect;
    EXPECT_TRUE(warnings(frame).empty()) << aspect;
  }
}

TEST(SurfaceWarnings, DitheredSurfacesAreNamedForAnyPattern) {
  const std::vector<DiagnosticId> expected = {DiagnosticId::surface_dithered};
  const std::vector<std::pair<const char*, std::function<bool(uint32_t, uint32_t)>>> patterns = {
      {"a quarter", [](uint32_t x, uint32_t y) { return x % 2 == 0 && y % 2 == 0; }},
      {"three quarters", [](uint32_t x, uint32_t y) { return x % 2 == 1 || y % 2 == 1; }},
      {"checkerboard", [](uint32_t x, uint32_t y) { return (x + y) % 2 == 0; }},
      {"rows", [](uint32_t, uint32_t y) { return y % 2 == 0; }},
      {"random", is_random},
      {"a sixteenth of the picture",
       [](uint32_t x, uint32_t y) { return x < 16 && y < 12 && (x + y) % 2 == 0; }}};
  for (const auto& [name, in_front] : patterns)
    for (const double distance : {0.05, 0.003}) {
      const auto front = in_front;
      EXPECT_EQ(warnings(seen(
                    [&](uint32_t x, uint32_t y) { return front(x, y) ? 0.5 - distance : 0.5; })),
                expected)
          << name << ", " << distance << " m";
    }
}

TEST(SurfaceWarnings, SlopesStepsAndGapsAreNotDithered) {
  EXPECT_TRUE(warnings(seen(plane)).empty());
  EXPECT_TRUE(warnings(seen([](uint32_t x, uint32_t) { return 0.5 + 0.01 * x; })).empty())
      << "slope of 50";
  EXPECT_TRUE(warnings(seen([](uint32_t x, uint32_t) { return x < 32 ? 0.5 : 0.45; })).empty())
      << "step";
  EXPECT_TRUE(
      warnings(seen([](uint32_t x, uint32_t y) { return 0.5 + 1e-4 * is_random(x, y); })).empty())
      << "roughness";
  CapturedFrame holes = seen(plane); // Two profiles in a checkerboard: ids separate their light.
  for (size_t i = 0; i < holes.profile.size(); ++i)
    if ((i + i / width) % 2 == 0) {
      holes.profile[i] = 2;
      holes.depth.values[i] = 0.45f;
    }
  EXPECT_TRUE(warnings(holes).empty());
}

TEST(SurfaceWarnings, SequenceIsWarnedAboutOnce) {
  CapturedFrame frame = seen([](uint32_t x, uint32_t y) { return (x + y) % 2 == 0 ? 0.45 : 0.5; });
  frame.rays.scale_x *= 8;
  Diagnostics diagnostics;
  EXPECT_TRUE(warn_of_surfaces(frame, diagnostics));
  EXPECT_FALSE(warn_of_surfaces(frame, diagnostics));
  EXPECT_EQ(diagnostics.list.size(), 2u);
}

// Busts with ears, folds and a thin knot, at both framings.
TEST(SurfaceWarnings, ShippedScenesGiveNone) {
  for (const char* scene : {"pan", "dynamic", "regular"})
    for (const double d_px : {0.0, 4.0}) {
      auto sequence = render_sequence(
          {scene, "", std::string(DERMIS_SOURCE_DIR) + "/configs/scenes/" + scene + ".json", d_px,
           40, 1, false},
          240, 136, {});
      ASSERT_TRUE(sequence) << sequence.error().text;
      EXPECT_TRUE(warnings(sequence->frames.front().captured).empty())
          << scene << " " << dithered_tiles(sequence->frames.front().captured);
    }
}

} // namespace
