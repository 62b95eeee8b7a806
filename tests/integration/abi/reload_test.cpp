// Tests reloads with a new description, which may change everything: pictures match those of a new
// graph.

#include "tests/integration/abi/dermis_fixture.hpp"

#include <algorithm>

namespace dermis::abi_test {
namespace {

struct Reload : DermisTest {
  static const dermis_slot* slot(const std::vector<dermis_slot>& slots, std::string_view name) {
    const auto found =
        std::ranges::find_if(slots, [&](const dermis_slot& one) { return one.name == name; });
    return found == slots.end() ? nullptr : &*found;
  }
  // Returns the picture of frame `index` with new images. A frame's noise follows its number.
  std::vector<float> picture(dermis_graph graph, uint64_t index) {
    make_images(graph);
    const auto bound = bindings(graph);
    last_frame = index - 1;
    dermis_frame one = frame(bound);
    EXPECT_OK(record(graph, one));
    return texels("lighting");
  }
};

TEST_F(Reload, ChangesWhichSlotsAreBoundAndTheirFormats) {
  const dermis_graph graph = make_graph();
  GraphOptions options;
  options.unbound = {"scatter_scale", "scattered_light"};
  options.formats = {{"depth", VK_FORMAT_D32_SFLOAT}};
  ASSERT_OK(reload_graph(graph, options));
  const auto slots = slots_of(graph);
  EXPECT_EQ(slot(slots, "albedo")->bound, 1u);
  EXPECT_EQ(slot(slots, "scatter_scale")->bound, 0u);
  EXPECT_EQ(slot(slots, "depth")->format, VK_FORMAT_D32_SFLOAT);
  ASSERT_OK(reload_graph(graph, {}));
  EXPECT_EQ(slot(slots_of(graph), "albedo")->bound, 0u);
  EXPECT_EQ(picture(graph, 1), picture(make_graph(), 1));
}

TEST_F(Reload, ChangesProfilesAndOverlays_MatchesANewGraph) {
  const dermis_graph graph = make_graph();
  const std::vector<float> skin = picture(graph, 1);
  GraphOptions marble;
  marble.profile = read_text("configs/profiles/marble.json");
  marble.overlays = {read_text("configs/overlays/accumulate.json")};
  marble.unbound.emplace_back("velocity");
  ASSERT_OK(reload_graph(graph, marble));
  const std::vector<float> reloaded = picture(graph, 2);
  EXPECT_NE(reloaded, skin);
  EXPECT_EQ(reloaded, picture(make_graph(marble), 2));
  GraphOptions none;
  none.profiles = false;
  ASSERT_OK(reload_graph(graph, none));
  EXPECT_EQ(picture(graph, 3), picture(make_graph(none), 3));
  ASSERT_OK(reload_graph(graph, GraphOptions{}));
  EXPECT_EQ(slots_of(graph).size(), slots_of(make_graph()).size())
      << "the overlay and its slots are removed";
  EXPECT_EQ(picture(graph, 4), picture(make_graph(), 4));
}

TEST_F(Reload, ChangesTheSizeOrKeepsIt) {
  const dermis_graph graph = make_graph();
  GraphOptions wide;
  wide.width = 96;
  ASSERT_OK(reload_graph(graph, wide));
  EXPECT_EQ(slot(slots_of(graph), "depth")->width, 96u);
  dermis_graph_desc all = DERMIS_GRAPH_DESC_INIT;
  all.keep = DERMIS_KEEP_ALL;
  ASSERT_OK(dermis_graph_reload(graph, &all, nullptr));
  EXPECT_EQ(slot(slots_of(graph), "depth")->width, 96u);
  EXPECT_EQ(slot(slots_of(graph), "albedo")->bound, 0u);
}

TEST_F(Reload, Failure_KeepsTheRunningGraphBitForBit) {
  const dermis_graph graph = make_graph(), untouched = make_graph();
  for (uint64_t index = 1; index < 4; ++index) {
    std::vector<GraphOptions> wrong(5);
    wrong[0].profile = "{ \"dermis_profile\": 1 }";
    wrong[1].overlays = {"{"};
    wrong[2].formats = {{"depth", VK_FORMAT_R8_UINT}};
    wrong[3].unbound = {"lighting"};
    wrong[4].text = "{ \"dermis\": 2 }";
    for (const GraphOptions& options : wrong) {
      dermis_report report = nullptr;
      EXPECT_EQ(reload_graph(graph, options, &report), DERMIS_ERROR_CONFIG);
      EXPECT_THAT(take(report).names, Not(IsEmpty()));
    }
    EXPECT_EQ(picture(graph, index), picture(untouched, index)) << "frame " << index;
  }
}

} // namespace
} // namespace dermis::abi_test
