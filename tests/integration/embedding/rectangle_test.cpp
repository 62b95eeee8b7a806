// Tests rectangles inside larger images: nothing outside is read or written, even if the size is
// not a multiple of the 8x8 tiles.

#include "tests/integration/embedding/two_views.hpp"
#include "tests/support/shipped_graphs.hpp"

namespace dermis::abi_test {
namespace {

struct RenderedPart {
  uint32_t x = 9, y = 5, width = 0, height = 0;
  bool has(uint32_t at_x, uint32_t at_y) const {
    return at_x >= x && at_y >= y && at_x < x + width && at_y < y + height;
  }
};

struct Rectangles : TwoViewsTest, ::testing::WithParamInterface<const char*> {
  static constexpr uint32_t side = 48;
  static constexpr float glare = 49152; // Exact in a half float.

  // Fills a slope of light over a bent surface. Outside of the rectangle the contents continue, or
  // contain values that must not be read.
  void fill_around(const RenderedPart& rectangle, bool hostile) {
    const auto put = [&](const std::string& slot, float outside, auto inside) {
      fill(slot, [&](uint32_t x, uint32_t y) {
        return hostile && !rectangle.has(x, y) ? outside : inside(x, y);
      });
    };
    put("lighting", glare,
        [](uint32_t x, uint32_t y) { return float(8 + (x * 7 + y * 3) % 32) / 32; });
    put("depth", 0.4990234375f,
        [](uint32_t x, uint32_t y) { return 0.5f + float(x % 5 + y % 3) / 8192; });
    put("material", 1,
        [](uint32_t x, uint32_t y) { return x % 13 == 0 && y % 11 == 0 ? 0.0f : 1.0f; });
  }
  // Runs two frames, of which the second has a history, and returns the light.
  std::vector<float> run(dermis_view view, const RenderedPart& rectangle, bool hostile,
                         uint64_t first) {
    for (uint64_t i = 0; i < 2; ++i) {
      fill_around(rectangle, hostile);
      dermis_frame one = bound_frame(graph, rectangle.width, rectangle.height);
      one.rect_x = rectangle.x;
      one.rect_y = rectangle.y;
      one.rect_width = rectangle.width;
      one.rect_height = rectangle.height;
      one.flags = i == 0 ? DERMIS_FRAME_RESET_HISTORY : 0u;
      rest(one);
      record_in(view, one, first + i);
    }
    return texels("lighting");
  }
};

TEST_P(Rectangles, NothingOutsideIsReadOrWritten) {
  make(read_text(dermis::shipped::graph_file(GetParam())), {}, side);
  uint64_t index = 1;
  for (uint32_t rest_of_tile = 0; rest_of_tile < 8; ++rest_of_tile) {
    const RenderedPart rectangle{.width = 16 + rest_of_tile,
                                 .height = 24 + (rest_of_tile * 3 + 7) % 8};
    const std::string where =
        std::to_string(rectangle.width) + "x" + std::to_string(rectangle.height) + " pixels, at ";
    const std::vector<float> plain = run(nullptr, rectangle, false, index);
    const std::vector<float> hostile = run(other, rectangle, true, index);
    index += 2;
    ASSERT_EQ(plain.size(), hostile.size());
    const size_t channels = plain.size() / (side * side);
    size_t read = 0, written = 0;
    std::string first_read, first_written;
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x)
        for (size_t c = 0; c < 3; ++c) {
          const size_t at = (size_t{y} * side + x) * channels + c;
          const bool inside = rectangle.has(x, y);
          const bool wrong = inside ? plain[at] != hostile[at] : hostile[at] != glare;
          std::string& first = inside ? first_read : first_written;
          if (wrong && first.empty()) first = where + std::to_string(x) + " " + std::to_string(y);
          (inside ? read : written) += wrong ? 1 : 0;
        }
    EXPECT_EQ(read, 0u) << "pixels outside are read: " << first_read;
    EXPECT_EQ(written, 0u) << "pixels outside are changed: " << first_written;
  }
}

INSTANTIATE_TEST_SUITE_P(, Rectangles,
                         ::testing::Values("burley", "afis", "afis_guided", "afis_published",
                                           "afis_seed", "fixed", "separable", "separable_jimenez",
                                           "sap", "sap_blend", "sap_residual", "pyramid", "hybrid",
                                           "hybrid_afis_separable"),
                         [](const auto& of) { return std::string(of.param); });

} // namespace
} // namespace dermis::abi_test
