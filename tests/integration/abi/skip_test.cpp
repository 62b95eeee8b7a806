// What frames do not need is not done, and the picture is the one that doing it would give.

#include "passes/subsurface/flat_light.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"

#include <cmath>

namespace dermis::abi_test {
namespace {

// What looks for flat light taken out.
constexpr const char* without_flat = R"({ "dermis_overlay": 1, "edits": [
  { "remove": "/passes/flat" }, { "remove": "/passes/classify/write/light_range" } ] })";

struct Skip : DermisTest {
  dermis_graph graph = nullptr;
  bool handed_out = false; // scattered_light is bound

  void make(bool profiles = true, bool skips = true) {
    GraphOptions options;
    options.text = read_text("configs/graphs/skin.json");
    options.profiles = profiles;
    if (!skips) options.overlays = {without_flat};
    if (handed_out) options.unbound = {"albedo", "scatter_scale"};
    graph = make_graph(options);
    ASSERT_NE(graph, nullptr);
    make_images(graph);
    fill("lighting", [](uint32_t x, uint32_t y) { return float((x * 37 + y * 61) % 97) / 64.0f; });
  }

  dermis_choice run_frame(uint32_t flags = 0, std::array<uint32_t, 4> bounds = {}) {
    const auto bound = bindings(graph);
    dermis_frame one = frame(bound);
    one.flags = flags;
    one.bounds_x = bounds[0], one.bounds_y = bounds[1];
    one.bounds_width = bounds[2], one.bounds_height = bounds[3];
    EXPECT_EQ(record(graph, one), DERMIS_OK) << dermis_last_error();
    dermis_choice choice = DERMIS_CHOICE_INIT;
    EXPECT_EQ(dermis_graph_choice(graph, last_frame, &choice), DERMIS_OK) << dermis_last_error();
    return choice;
  }

  void no_subsurface() {
    fill("material", [](uint32_t, uint32_t) { return 0.0f; });
  }
};

TEST_F(Skip, WithoutAProfileThePlanIsEmptyAndTheLightStays) {
  make(false);
  no_subsurface();
  const auto before = texels("lighting");
  const dermis_choice choice = run_frame();
  EXPECT_EQ(choice.skips, DERMIS_SKIP_NO_MATERIAL);
  EXPECT_EQ(choice.dispatches, 0u);
  EXPECT_EQ(choice.groups, 0u);
  dermis_memory memory = DERMIS_MEMORY_INIT;
  ASSERT_EQ(dermis_graph_memory(graph, &memory), DERMIS_OK);
  EXPECT_EQ(memory.transient_bytes, 0u);
  EXPECT_EQ(texels("lighting"), before);
}

TEST_F(Skip, WithoutAProfileLightIsStillHandedOut) {
  handed_out = true;
  make(false);
  no_subsurface();
  const auto before = texels("lighting");
  EXPECT_EQ(run_frame().dispatches, 1u);
  EXPECT_EQ(texels("lighting"), before);
  const auto out = texels("scattered_light");
  for (size_t i = 0; i < out.size(); ++i)
    if (i % 4 != 3) {
      ASSERT_EQ(out[i], before[i]) << i;
    }
}

TEST_F(Skip, EmptyBoundsLaunchNothingAndTheLightStays) {
  make();
  const auto before = texels("lighting");
  const dermis_choice choice = run_frame(DERMIS_FRAME_BOUNDS);
  EXPECT_EQ(choice.skips, DERMIS_SKIP_NO_BOUNDS);
  EXPECT_EQ(choice.dispatches, 0u);
  EXPECT_EQ(choice.groups, 0u);
  EXPECT_EQ(texels("lighting"), before);
}

TEST_F(Skip, EmptyBoundsStillHandOutLight) {
  handed_out = true;
  make();
  const auto before = texels("lighting");
  EXPECT_EQ(run_frame(DERMIS_FRAME_BOUNDS, {64, 0, 8, 8}).dispatches, 1u); // outside of the picture
  const auto out = texels("scattered_light");
  for (size_t i = 0; i < out.size(); ++i)
    if (i % 4 != 3) {
      ASSERT_EQ(out[i], before[i]) << i;
    }
}

TEST_F(Skip, AFrameAfterEmptyBoundsIsAsAnyOther) {
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
  const dermis_choice whole = run_frame();
  const auto picture = texels("lighting");
  make();
  fill("material", patch);
  const dermis_choice bounded = run_frame(DERMIS_FRAME_BOUNDS, {20, 12, 20, 18});
  EXPECT_EQ(bounded.scattering_tiles, whole.scattering_tiles);
  EXPECT_EQ(texels("lighting"), picture);
}

TEST_F(Skip, BoundsWithoutTheirFlagAreRefused) {
  make();
  const auto bound = bindings(graph);
  dermis_frame one = frame(bound);
  one.bounds_width = 8;
  EXPECT_EQ(record(graph, one), DERMIS_ERROR_ARGUMENT);
  EXPECT_THAT(dermis_last_error(), testing::HasSubstr("DERMIS_FRAME_BOUNDS"));
}

TEST_F(Skip, WithNothingOnScreenOnlyTilesAreLookedAt) {
  make();
  no_subsurface();
  const auto before = texels("lighting");
  const dermis_choice choice = run_frame();
  EXPECT_EQ(choice.skips, DERMIS_SKIP_NOTHING_SEEN);
  EXPECT_EQ(choice.groups, 64u + 1 + 1); // classes, flat light by 64 tiles, the list
  EXPECT_EQ(texels("lighting"), before);
}

TEST_F(Skip, FlatLightIsCopiedAndThePictureStaysWithinTheTolerance) {
  const auto light = [](uint32_t x, uint32_t) {
    return 0.75f + 0.0005f * float(x % 2);
  }; // within half a step of 8 bits
  make(true, false);
  fill("lighting", light);
  EXPECT_EQ(run_frame().flat_tiles, 0u);
  const auto unskipped = texels("lighting");
  make();
  fill("lighting", light);
  const dermis_choice choice = run_frame();
  EXPECT_EQ(choice.flat_tiles, 64u);
  EXPECT_EQ(choice.scattering_tiles, 0u);
  EXPECT_EQ(choice.skips, DERMIS_SKIP_FLAT_LIGHT);
  const auto skipped = texels("lighting");
  // What differs: the tolerance, and three roundings to half floats (2^-11 each) of the pyramid's own.
  const double bound = 0.7505 * (subsurface::flat_tolerance + 3.0 / 2048);
  for (size_t i = 0; i < skipped.size(); ++i)
    ASSERT_NEAR(skipped[i], unskipped[i], i % 4 == 3 ? 0 : bound) << i;
}

TEST_F(Skip, LightThatOneFarTileBreaksIsNotFlatAsFarAsItReaches) {
  make();
  fill("lighting", [](uint32_t x, uint32_t y) { return x < 8 && y < 8 ? 1.0f : 0.5f; });
  const dermis_choice choice = run_frame();
  // Skin's d is two pixels here: 20 d are five tiles, and the picture has eight.
  EXPECT_EQ(choice.flat_tiles + choice.scattering_tiles, 64u);
  const auto reach = static_cast<uint32_t>(std::ceil(subsurface::flat_reach_d * 3.67 / 3.5 / 0.5 / 8));
  EXPECT_EQ(choice.scattering_tiles, (reach + 1) * (reach + 1));
}

TEST_F(Skip, ScatteringBelowAPixelIsCopiedExactly) {
  make();
  const auto before = texels("lighting");
  const auto bound = bindings(graph);
  dermis_frame one = frame(bound);
  one.metres_per_unit = 100; // a pixel is five centimetres
  ASSERT_EQ(record(graph, one), DERMIS_OK);
  dermis_choice choice = DERMIS_CHOICE_INIT;
  ASSERT_EQ(dermis_graph_choice(graph, last_frame, &choice), DERMIS_OK);
  EXPECT_EQ(choice.copied_tiles, 64u);
  EXPECT_EQ(choice.skips, DERMIS_SKIP_SUBPIXEL);
  const auto after = texels("lighting");
  for (size_t i = 0; i < after.size(); ++i)
    if (i % 4 != 3) {
      ASSERT_EQ(after[i], before[i]) << i; // light was given in halves
    }
}

} // namespace
} // namespace dermis::abi_test
