// Tests that clearing only the tiles outside a list has the effect of clearing the image.

#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <regex>

namespace dermis::abi_test {
namespace {

struct ClearTiles : DermisTest {
  // Returns the samples and light of a frame before which the right half had no subsurface.
  std::vector<std::vector<float>> after_a_gap(const std::string& graph_text) {
    GraphOptions options;
    options.text = graph_text;
    options.unbound = {"albedo", "scatter_scale", "velocity"};
    dermis_graph graph = make_bound_graph(options);
    last_frame = 0; // samples depend on the frame's index
    for (const uint32_t width : {64u, 64u, 36u, 64u}) {
      fill("material", [&](uint32_t x, uint32_t) { return x < width ? 1.0f : 0.0f; });
      fill("lighting", [](uint32_t x, uint32_t y) { return float((x * 37 + y * 61) % 97) / 64; });
      dermis_frame one = bound_frame(graph);
      rest(one);
      EXPECT_OK(record(graph, one));
    }
    return {texels("sampling"), texels("scattered_light")};
  }
};

TEST_F(ClearTiles, EqualsClear) {
  for (const char* name : {"sap_residual", "afis_guided"}) {
    SCOPED_TRACE(name);
    const std::string text = read_text(dermis::shipped::graph_file(name));
    const auto found = after_a_gap(text);
    const auto expected = after_a_gap(std::regex_replace(
        text,
        std::regex(R"re("type": "subsurface.clear_tiles", "read": \{ "listed": "[a-z_]*" \})re"),
        R"("type": "clear")"));
    EXPECT_TRUE(found == expected);
    const size_t history = 4 * (32 * 64 + 16), gap = 4 * (32 * 64 + 48); // alpha: no history
    EXPECT_EQ(found[0][history + 3], 0);
    EXPECT_EQ(found[0][gap + 3], 1);
  }
}

} // namespace
} // namespace dermis::abi_test
