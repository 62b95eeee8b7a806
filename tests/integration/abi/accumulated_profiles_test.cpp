// Accumulation (configs/overlays/accumulate.json) keeps the history of one profile out of another
// profile. This also holds where a surface moves by a fraction of a pixel, so that history is
// filtered over 4x4 texels.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::abi_test {
namespace {

constexpr uint32_t border = 32; // In 64 columns: profile 1 to its left, profile 2 from there on.

struct AccumulatedProfiles : DermisTest {
  dermis_graph make() {
    GraphOptions options = shipped_options("configs/graphs/burley.json");
    options.overlays = {read_text("configs/overlays/accumulate.json")};
    options.formats.emplace_back("lighting", VK_FORMAT_R32G32B32A32_SFLOAT);
    options.profile_count = 2;
    const dermis_graph graph = make_graph(options);
    EXPECT_OK(dermis_graph_set_setting(graph, "accumulate_clip", "0", nullptr));
    make_images(graph);
    fill("material", [](uint32_t x, uint32_t) { return x < border ? 1.0f : 2.0f; });
    fill("velocity", [](uint32_t, uint32_t) { return 0.5f; });
    return graph;
  }

  void record_frame(dermis_graph graph) {
    // Even light on profile 1, a checkerboard of glare on profile 2.
    fill("lighting", [](uint32_t x, uint32_t y) {
      return x < border ? 1.0f : ((x ^ y) & 1) != 0 ? 2000.0f : 0.0f;
    });
    dermis_frame one = bound_frame(graph);
    for (float* from_world : {one.view_from_world, one.previous_view_from_world})
      for (size_t i = 0; i < 16; i += 5)
        from_world[i] = 1.0f;
    std::copy(std::begin(one.clip_from_view), std::end(one.clip_from_view),
              one.previous_clip_from_view);
    ASSERT_OK(record(graph, one));
  }
};

TEST_F(AccumulatedProfiles, KeepEvenLightNextToGlare) {
  const dermis_graph graph = make();
  for (int i = 0; i < 6; ++i) {
    record_frame(graph);
    const std::vector<float> light = texels("lighting");
    for (uint32_t y = 0; y < 64; ++y)
      for (uint32_t x = 0; x < border; ++x) // Half floats between passes: 2^-11 each time.
        ASSERT_NEAR(light[4 * (y * 64 + x)], 1.0f, std::ldexp(1.0f, -9))
            << "frame " << i << ", pixel " << x << ' ' << y;
  }
}

} // namespace
} // namespace dermis::abi_test
