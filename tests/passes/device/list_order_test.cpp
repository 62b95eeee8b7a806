// Pictures and counters, by which a budget ranks configurations, do not depend on the order of the
// lists of tiles: a pass after each list permutes it.
#include "framegraph/model/read_graph.hpp"
#include "framegraph/text/diagnostic.hpp"
#include "passes/common/dispatch.hpp"
#include "tests/passes/device/golden.hpp"

#include "test_shuffle_lists.spv.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace dermis::testing {
namespace {

using Json = nlohmann::ordered_json;

constexpr Port shuffle_ports[] = {
    {"tiles", Usage::storage_buffer_update, false, "uint", "", {}},
    {"level_tiles", Usage::storage_buffer_update, true, "uint", "", {}}};

class ListOrder : public DevicePlayer, public ::testing::WithParamInterface<std::string> {
protected:
  void SetUp() override {
    DevicePlayer::SetUp();
    pass_types.add(
        {"test.shuffle", "test_shuffle_lists", "", shuffle_ports, {}, subsurface::single_group});
    more_kernels = {{"test_shuffle_lists", test_shuffle_lists_spirv}};
  }

  // Returns the graph with a pass after each list that permutes it.
  std::optional<RealGraph> shuffled(const RealGraph& graph) const {
    Json json = Json::parse(graph.text, nullptr, true, true), passes = Json::array();
    for (const Json& pass : json["passes"]) {
      passes.push_back(pass);
      const std::string type = pass["type"];
      if (type != "subsurface.sap_tiles" && type != "subsurface.tile_list" &&
          type != "subsurface.allocate_samples")
        continue;
      Json shuffle = {{"pass", fmt::format("shuffle_{}", passes.size())}, {"type", "test.shuffle"}};
      if (pass.contains("when")) shuffle["when"] = pass["when"];
      for (const char* port : {"tiles", "level_tiles"})
        if (pass["write"].contains(port)) shuffle["write"][port] = pass["write"][port];
      passes.push_back(shuffle);
    }
    EXPECT_GT(passes.size(), json["passes"].size());
    json["passes"] = passes;
    Diagnostics diagnostics;
    const std::string text = json.dump(1);
    const auto document = parse_document(graph.name, text, diagnostics);
    auto read = document ? read_graph(*document, pass_types, diagnostics) : std::nullopt;
    EXPECT_TRUE(read) << format_as_json(diagnostics);
    if (!read) return std::nullopt;
    return RealGraph{graph.name, text, std::move(*read)};
  }

  Played frames(const RealGraph& graph) {
    const Show show = golden_show(graph.graph);
    Diagnostics diagnostics;
    const auto compiled = compile(compile_input(graph, show), diagnostics);
    EXPECT_TRUE(compiled) << format_as_json(diagnostics);
    return compiled ? play(graph, show, compiled->plan, false) : Played{};
  }
};

INSTANTIATE_TEST_SUITE_P(Graphs, ListOrder,
                         ::testing::Values("separable", "afis_guided", "sap", "sap_residual",
                                           "hybrid", "skin"),
                         [](const auto& graph) { return graph.param; });

TEST_P(ListOrder, PicturesAndCountersDoNotDependOnOrder) {
  const auto graph = shipped_graph(GetParam(), pass_types);
  ASSERT_TRUE(graph);
  const auto other = shuffled(*graph);
  ASSERT_TRUE(other);
  const Played played = frames(*graph);
  const std::vector<subsurface::FrameCounters> counted = counters;
  ASSERT_FALSE(played.empty());
  EXPECT_GT(counted.back().scattering_tiles, 4u);
  EXPECT_TRUE(frames(*other) == played);
  EXPECT_TRUE(std::ranges::equal(bytes_of(counters), bytes_of(counted)));
}

} // namespace
} // namespace dermis::testing
