// Tests that unneeded work of a frame is skipped without changing the picture.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "passes/common/uniform_light.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"

#include <cmath>

namespace dermis::abi_test {
namespace {

// An overlay that removes the detection of uniform light, and what else reads the range of light.
constexpr const char* without_uniform_light = R"({ "dermis_overlay": 2, "edits": [
  { "remove": "/passes/classify_uniform_light" }, { "remove": "/passes/classify/write/light_range" },
  { "remove": "/passes/classify/write/light_cells" }, { "remove": "/passes/tile_change" },
  { "remove": "/passes/tile_histogram" }, { "remove": "/passes/select_tiles" },
  { "remove": "/passes/horizontal_tiles" }, { "remove": "/passes/vertical_tiles" },
  { "remove": "/passes/vertical_and_copies" } ] })";

// Reach of the light test in tiles: a pixel is 0.5 mm, skin's widest d is 3.67 / 3.5 mm.
const auto reach =
    static_cast<uint32_t>(std::ceil(subsurface::uniform_reach_d * 3.67 / 3.5 / 0.5 / 8));

struct Skip : DermisTest {
  dermis_graph graph = nullptr;
  bool handed_out = false; // Whether scattered_light is bound.

  void make(bool profiles = true, bool skips = true) {
    GraphOptions options = skin();
    options.profiles = profiles;
    if (!skips) options.overlays = {without_uniform_light};
    if (handed_out) options.unbound = {"albedo", "scatter_scale"};
    graph = make_graph(options);
    // The probe has groups of its own, in some frames.
    ASSERT_OK(dermis_graph_set_setting(graph, "probe", "\"off\"", nullptr));
    make_images(graph);
    fill("lighting", [](uint32_t x, uint32_t y) { return float((x * 37 + y * 61) % 97) / 64.0f; });
  }

  static GraphOptions skin() { return shipped_options("configs/graphs/skin.json"); }

  demo::ReportedFrame run_frame(uint32_t flags = 0, std::array<uint32_t, 4> bounds = {}) {
    dermis_frame one = bound_frame(graph);
    one.flags = flags;
    one.bounds_x = bounds[0], one.bounds_y = bounds[1];
    one.bounds_width = bounds[2], one.bounds_height = bounds[3];
    return record_and_read(graph, one);
  }

  void no_subsurface() {
    fill("material", [](uint32_t, uint32_t) { return 0.0f; });
  }
};

TEST_F(Skip, NoProfile_EmptyPlanAndUnchangedLight) {
  make(false);
  no_subsurface();
  const auto before = texels("lighting");
  const demo::ReportedFrame choice = run_frame();
  EXPECT_EQ(choice.skips, DERMIS_SKIP_NO_MATERIAL);
  EXPECT_EQ(choice.dispatches, 0u);
  EXPECT_EQ(choice.groups, 0u);
  const dermis_memory memory = memory_of(graph);
  EXPECT_EQ(memory.transient_bytes, 0u);
  EXPECT_EQ(texels("lighting"), before);
}

TEST_F(Skip, NoProfile_LightIsStillExported) {
  handed_out = true;
  make(false);
  no_subsurface();
  const auto before = texels("lighting");
  EXPECT_EQ(run_frame().dispatches, 1u);
  EXPECT_EQ(texels("lighting"), before);
  expect_equal_rgb(texels("scattered_light"), before);
}

TEST_F(Skip, EmptyBounds_LaunchNothing) {
  make();
  const auto before = texels("lighting");
  const demo::ReportedFrame choice = run_frame(DERMIS_FRAME_BOUNDS);
  EXPECT_EQ(choice.skips, DERMIS_SKIP_NO_BOUNDS);
  EXPECT_EQ(choice.dispatches, 0u);
  EXPECT_EQ(choice.groups, 0u);
  EXPECT_EQ(texels("lighting"), before);
}

TEST_F(Skip, EmptyBounds_LightIsStillExported) {
  handed_out = true;
  make();
  const auto before = texels("lighting");
  // Outside of the picture.
  EXPECT_EQ(run_frame(DERMIS_FRAME_BOUNDS, {64, 0, 8, 8}).dispatches, 1u);
  expect_equal_rgb(texels("scattered_light"), before);
}

TEST_F(Skip, FrameAfterEmptyBounds_IsNormal) {
  make();
  const auto before = texels("lighting");
  run_frame();
  const auto picture = texels("lighting");
  make();
  run_frame(DERMIS_FRAME_BOUNDS);
  run_frame();
  EXPECT_EQ(texels("lighting"), picture);
  EXPECT_NE(picture, before);
}

TEST_F(Skip, BoundsAroundAllSubsurfaceChangeNothing) {
  make();
  const auto patch = [](uint32_t x, uint32_t y) {
    return x >= 20 && x < 40 && y >= 12 && y < 30 ? 1.0f : 0.0f;
  };
  fill("material", patch);
  const demo::ReportedFrame whole = run_frame();
  const auto picture = texels("lighting");
  make();
  fill("material", patch);
  const demo::ReportedFrame bounded = run_frame(DERMIS_FRAME_BOUNDS, {20, 12, 20, 18});
  EXPECT_EQ(bounded.scattering_tiles, whole.scattering_tiles);
  EXPECT_EQ(texels("lighting"), picture);
}

TEST_F(Skip, BoundsWithoutTheirFlagAreRejected) {
  make();
  dermis_frame one = bound_frame(graph);
  one.bounds_width = 8;
  EXPECT_THAT(record(graph, one), Fails(DERMIS_ERROR_ARGUMENT, "DERMIS_FRAME_BOUNDS"));
}

TEST_F(Skip, NothingOnScreen_OnlyClassifiesTiles) {
  make();
  no_subsurface();
  const auto before = texels("lighting");
  const demo::ReportedFrame choice = run_frame();
  EXPECT_EQ(choice.skips, DERMIS_SKIP_NOTHING_SEEN);
  EXPECT_EQ(choice.groups,
            4u + 1 + 1); // Classes by 4x4 tiles, uniform light by 64 tiles, the list.
  EXPECT_EQ(texels("lighting"), before);
}

TEST_F(Skip, FlatLight_IsCopiedWithinTheTolerance) {
  const auto light = [](uint32_t x, uint32_t) {
    return 0.75f + 0.0005f * float(x % 2);
  }; // Within half a step of 8 bits.
  make(true, false);
  fill("lighting", light);
  EXPECT_EQ(run_frame().uniform_tiles, 0u);
  const auto unskipped = texels("lighting");
  make();
  fill("lighting", light);
  const demo::ReportedFrame choice = run_frame();
  EXPECT_EQ(choice.uniform_tiles, 64u);
  EXPECT_EQ(choice.scattering_tiles, 0u);
  EXPECT_EQ(choice.skips, DERMIS_SKIP_UNIFORM_LIGHT);
  const auto skipped = texels("lighting");
  // Difference: the tolerance, and the pyramid's three roundings to half floats (2^-11 each).
  const double bound = 0.7505 * (subsurface::uniform_tolerance + 3.0 / 2048);
  for (size_t i = 0; i < skipped.size(); ++i)
    ASSERT_NEAR(skipped[i], unskipped[i], i % 4 == 3 ? 0 : bound) << i;
}

TEST_F(Skip, FlatLight_IsExportedUnchanged) {
  handed_out = true;
  make();
  fill("lighting", [](uint32_t, uint32_t) { return 0.75f; });
  EXPECT_EQ(run_frame().uniform_tiles, 64u);
  const auto out = texels("scattered_light");
  expect_equal_rgb(out, std::vector<float>(out.size(), 0.75f));
}

TEST_F(Skip, CopiedLight_IsEqualForEveryTexturing) {
  // Once from the lighting directly, and once through `scattered`, which passes of overlays need.
  for (const char* texturing : {"\"post\"", "\"pre_post\"", "\"pre\""}) {
    const auto picture = [&](bool through) {
      GraphOptions options = skin();
      if (through)
        options.overlays = {R"({ "dermis_overlay": 2, "edits": [
          { "set": "/settings/copied", "to": { "enum": ["scattered"], "default": "scattered" } },
          { "set": "/settings/last_step", "to": { "enum": ["separate"], "default": "separate" } },
          { "set": "/passes/combine/set/copied", "to": "scattered" } ] })"};
      options.unbound = {"scatter_scale", "scattered_light"};
      graph = make_graph(options);
      EXPECT_OK(dermis_graph_set_setting(graph, "texturing", texturing, nullptr));
      make_images(graph);
      fill("lighting",
           [](uint32_t x, uint32_t y) { return float((x * 37 + y * 61) % 97) / 64.0f; });
      fill("albedo", [](uint32_t x, uint32_t y) { return float((x * 13 + y * 7) % 32) / 32.0f; });
      dermis_frame one = bound_frame(graph);
      one.metres_per_unit = 100; // All scattering is below a pixel.
      EXPECT_OK(record(graph, one));
      return texels("lighting");
    };
    EXPECT_EQ(picture(false), picture(true)) << texturing;
  }
}

TEST_F(Skip, OneDifferentTile_IsSeenWithinTheReach) {
  make();
  fill("lighting", [](uint32_t x, uint32_t y) { return x < 8 && y < 8 ? 1.0f : 0.5f; });
  const demo::ReportedFrame choice = run_frame();
  // Skin's d is two pixels here: 20 d are five tiles, and the picture has eight.
  EXPECT_EQ(choice.uniform_tiles + choice.scattering_tiles, 64u);
  EXPECT_EQ(choice.scattering_tiles, (reach + 1) * (reach + 1));
}

TEST_F(Skip, DifferenceInACell_IsSeenExactlyWithinTheReach) {
  // Cells of 4x4 tiles are tested first. Differing light in a cell is beyond the reach of some
  // neighbouring tiles.
  for (const uint32_t column : {0u, 1u, 2u, 3u}) {
    make();
    fill("lighting", [&](uint32_t x, uint32_t) { return x / 8 == column ? 1.0f : 0.5f; });
    const demo::ReportedFrame choice = run_frame();
    const uint32_t scattering =
        std::min(column + reach, 7u) - (column > reach ? column - reach : 0u) + 1;
    EXPECT_EQ(choice.scattering_tiles, 8 * scattering) << column;
    EXPECT_EQ(choice.uniform_tiles, 64 - 8 * scattering) << column;
  }
}

TEST_F(Skip, SubpixelScattering_LightIsNotTested) {
  GraphOptions options = skin();
  options.unbound = {"albedo", "scattered_light"};
  graph = make_bound_graph(options);
  fill("lighting", [](uint32_t, uint32_t) { return 0.5f; });
  fill("scatter_scale", [](uint32_t x, uint32_t y) { return x < 8 && y < 8 ? 0.0f : 1.0f; });
  const demo::ReportedFrame choice = run_frame();
  EXPECT_EQ(choice.copied_tiles, 1u);
  EXPECT_EQ(choice.scattering_tiles, (reach + 1) * (reach + 1) - 1); // Its light is not tested.
}

TEST_F(Skip, BoundsCanCutTiles) {
  // Pixels outside of the bounds count as having no subsurface, also in the middle of a tile.
  for (const std::array<uint32_t, 4> bounds : {std::array<uint32_t, 4>{3, 5, 1, 1},
                                               {7, 7, 2, 2},
                                               {0, 0, 64, 1},
                                               {33, 0, 30, 64},
                                               {8, 8, 8, 8}}) {
    make();
    const demo::ReportedFrame choice = run_frame(DERMIS_FRAME_BOUNDS, bounds);
    const auto tiles = [](uint32_t first, uint32_t count) {
      return (first + count - 1) / 8 - first / 8 + 1;
    };
    EXPECT_EQ(choice.scattering_tiles + choice.uniform_tiles,
              tiles(bounds[0], bounds[2]) * tiles(bounds[1], bounds[3]));
  }
}

TEST_F(Skip, ToolsGetTheClassOfEachTile) {
  GraphOptions options = skin();
  options.overlays = {read_text("configs/overlays/debug_tile_class.json")};
  graph = make_bound_graph(options);
  fill("material", [](uint32_t x, uint32_t) { return x < 32 ? 1.0f : 0.0f; });
  fill("lighting", [](uint32_t, uint32_t) { return 0.5f; });
  const demo::ReportedFrame choice = run_frame();
  EXPECT_EQ(choice.uniform_tiles, 32u);
  const auto shown = texels("tile_class");
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      ASSERT_EQ(shown[4 * (64 * y + x)], x < 32 ? 3.0f : 0.0f) << x << ", " << y; // Flat light.
      ASSERT_EQ(shown[4 * (64 * y + x) + 1], x < 32 ? 1.0f : 0.0f);
    }
}

TEST_F(Skip, ScatteringBelowAPixelIsCopiedExactly) {
  make();
  const auto before = texels("lighting");
  dermis_frame one = bound_frame(graph);
  one.metres_per_unit = 100; // A pixel is 5 cm.
  const demo::ReportedFrame choice = record_and_read(graph, one);
  EXPECT_EQ(choice.copied_tiles, 64u);
  EXPECT_EQ(choice.skips, DERMIS_SKIP_SUBPIXEL);
  // Classes, uniform light, the list, and once over the listed tiles.
  EXPECT_EQ(choice.groups, 4u + 1 + 1 + 64);
  expect_equal_rgb(texels("lighting"), before); // The input light consists of half floats.
}

} // namespace
} // namespace dermis::abi_test
