// Tests rescaled histories: every texel is the nearest texel of the previous size, in each mip and
// layer and for each format that a kernel can write.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

#include <fmt/core.h>

#include <algorithm>

namespace dermis::testing {
namespace {

struct RescaleSize {
  uint32_t width, height;
};

struct RescaledImage {
  Format format;
  uint32_t mips, layers, frames;
};

class RescaledHistory : public ExecutorTest {
protected:
  static uint32_t pattern(uint32_t x, uint32_t y, uint32_t seed) {
    return (3 * x + 5 * y + 7 * seed) % 32;
  }

  static uint32_t seed_of(const RescaledImage& image, uint32_t mip, uint32_t layer) {
    return 1 + mip * image.layers + layer;
  }

  // `kept` gets a pattern in each mip and layer; one result per subresource shows it from `frames`
  // frames ago.
  static SmallGraph make_graph(const RescaledImage& image) {
    SmallGraph g;
    ResourceDeclaration& kept = g.history("kept", image.frames);
    kept.formats = {image.format};
    kept.mips = image.mips;
    kept.layers = image.layers;
    kept.history.on_resize = HistoryDeclaration::OnResize::rescale;
    const bool ids = has_unsigned_components(image.format);
    for (uint32_t mip = 0; mip < image.mips; ++mip)
      for (uint32_t layer = 0; layer < image.layers; ++layer) {
        const std::string part = fmt::format("#{}[{}]", mip, layer),
                          result = fmt::format("result{}{}", mip, layer);
        g.exported(result);
        g.pass("show " + part, "test.show",
               {{ids ? "ids" : "a", fmt::format("kept{}@-{}", part, image.frames)}},
               {{"target", result}});
        g.set(g.pass("stamp " + part, "test.stamp", {}, {{ids ? "ids" : "target", "kept" + part}}),
              "seed", seed_of(image, mip, layer));
      }
    return g;
  }

  std::vector<TestImage> bind_results(const SmallGraph& g, const RescaledImage& image) {
    std::vector<TestImage> results;
    for (uint32_t mip = 0; mip < image.mips; ++mip)
      for (uint32_t layer = 0; layer < image.layers; ++layer)
        results.push_back(bind(g, fmt::format("result{}{}", mip, layer), {}));
    return results;
  }

  static uint32_t extent(uint32_t side, uint32_t mip) { return std::max(side >> mip, 1u); }

  void expect_nearest(const std::vector<float>& shown, RescaleSize from, RescaleSize to,
                      uint32_t mip, uint32_t seed) {
    const RescaleSize before{extent(from.width, mip), extent(from.height, mip)},
        after{extent(to.width, mip), extent(to.height, mip)};
    for (uint32_t y = 0; y < after.height; ++y)
      for (uint32_t x = 0; x < after.width; ++x) {
        const uint32_t old_x = (2 * x + 1) * before.width / (2 * after.width),
                       old_y = (2 * y + 1) * before.height / (2 * after.height);
        // Half of the distance between two values of the pattern, because formats of 8 bits round
        // the values.
        ASSERT_NEAR(shown[y * to.width + x], pattern(old_x, old_y, seed) / 32.0f, 0.5f / 32)
            << "texel " << x << ' ' << y << " of mip " << mip;
      }
  }

  void resize(const RescaledImage& image, RescaleSize from, RescaleSize to) {
    const SmallGraph g = make_graph(image);
    make_executor(g, from.width, from.height);
    bind_results(g, image);
    for (uint32_t i = 0; i < image.frames; ++i)
      ASSERT_FALSE(frame());
    replaced = std::move(executor);
    make_executor(g, to.width, to.height);
    ASSERT_TRUE(executor->history_state(0, false, replaced.get()).valid);
    const std::vector<TestImage> results = bind_results(g, image);
    ASSERT_FALSE(frame());
    for (uint32_t mip = 0; mip < image.mips; ++mip)
      for (uint32_t layer = 0; layer < image.layers; ++layer)
        expect_nearest(read(results[mip * image.layers + layer]), from, to, mip,
                       seed_of(image, mip, layer));
    wait();
    replaced.reset();
    executor.reset();
  }
};

TEST_F(RescaledHistory, HasTheNearestTexelsInEveryFormat) {
  uint32_t formats = 0;
  for (uint32_t f = 1; f < static_cast<uint32_t>(Format::count); ++f) {
    const auto format = static_cast<Format>(f);
    // No kernel can write these formats.
    if (format_info(format).depth || format == Format::rgba8_srgb) continue;
    SCOPED_TRACE(format_info(format).name);
    resize({format, 1, 1, 1}, {13, 9}, {21, 5});
    ++formats;
  }
  EXPECT_EQ(formats, 15u);
}

TEST_F(RescaledHistory, HasTheNearestTexelsInEveryMipAndLayer) {
  for (const Format format : {Format::rgba16f, Format::r16_uint})
    for (const auto& [from, to] : {std::pair<RescaleSize, RescaleSize>{{16, 16}, {29, 7}},
                                   {{29, 7}, {16, 16}},
                                   {{5, 64}, {64, 5}}}) {
      SCOPED_TRACE(fmt::format("{} {}x{}", format_info(format).name, to.width, to.height));
      resize({format, 3, 2, 1}, from, to);
      resize({format, 1, 3, 1}, from, to);
    }
}

// Padding around the contents does not scale with them.
TEST_F(RescaledHistory, PaddedImagesRestart) {
  for (const auto& [align, border] : {std::pair{64u, 0u}, {1u, 2u}}) {
    SmallGraph g = make_graph({Format::r32f, 1, 1, 1});
    for (ResourceDeclaration& one : g.graph.resources)
      if (one.name == "kept") one.size.align = align, one.size.border = border;
    make_executor(g, 32, 32);
    bind_results(g, {Format::r32f, 1, 1, 1});
    ASSERT_FALSE(frame());
    replaced = std::move(executor);
    make_executor(g, 40, 40);
    EXPECT_FALSE(executor->history_state(0, false, replaced.get()).valid) << align;
    wait();
    replaced.reset();
    executor.reset();
  }
}

TEST_F(RescaledHistory, HasTheNearestTexelsOfEveryFrame) {
  resize({Format::r32f, 2, 1, 2}, {16, 16}, {9, 31});
}

} // namespace
} // namespace dermis::testing
