// Compares the tiles that kernels select with choice::select_tiles, in views whose tiles many
// groups share.
#include "passes/choice/tile_selection.hpp"
#include "passes/common/dispatch.hpp"
#include "tests/shaders/sap/tile_list_graph.hpp"

#include <fmt/format.h>

#include <random>

namespace dermis::subsurface::selected_tiles {
namespace {

using testing::answer_columns, testing::buffer_port;

constexpr Port input_ports[] = {buffer_port("classes", Usage::storage_buffer_write),
                                buffer_port("list_state", Usage::storage_buffer_write),
                                buffer_port("tile_changes", Usage::storage_buffer_write),
                                buffer_port("before", Usage::storage_buffer_write)};
constexpr Port output_ports[] = {buffer_port("tile_weights", Usage::storage_buffer_read),
                                 buffer_port("tiles", Usage::storage_buffer_read),
                                 buffer_port("arguments", Usage::storage_buffer_read),
                                 testing::answers_port};

std::string graph_text(uint32_t rows, bool continues) {
  const std::string_view before = continues ? R"(, "before": "before")" : "";
  return fmt::format(
      R"({{ "dermis": 2, "name": "selection",
  "resources": {{
    "classes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "list_state": {{ "buffer": {{ "stride": 4, "count": "view/64", "extra": 8 }} }},
    "tile_changes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "before": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "histogram": {{ "buffer": {{ "stride": 2048, "count": "view/256" }} }},
    "tile_weights": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "tiles": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
    "answers": {{ "format": "rgba32_uint", "size": [{0}, {1}] }} }},
  "passes": [
    {{ "pass": "input", "type": "test.input", "write": {{ "classes": "classes",
      "list_state": "list_state", "tile_changes": "tile_changes", "before": "before" }} }},
    {{ "pass": "histogram", "type": "subsurface.tile_histogram",
      "read": {{ "classes": "classes", "tile_changes": "tile_changes" {2} }},
      "write": {{ "histogram": "histogram" }} }},
    {{ "pass": "select", "type": "subsurface.select_tiles",
      "read": {{ "tile_changes": "tile_changes", "histogram": "histogram" {2} }},
      "write": {{ "classes": "classes", "list_state": "list_state",
                 "tile_weights": "tile_weights", "selected_tiles": "tiles",
                 "selected_arguments": "arguments" }} }},
    {{ "pass": "output", "type": "test.output",
      "read": {{ "tile_weights": "tile_weights", "tiles": "tiles", "arguments": "arguments" }},
      "write": {{ "target": "answers" }} }} ],
  "exports": ["answers"] }})",
      answer_columns, rows, before);
}

struct Tiles {
  uint32_t width = 0, height = 0, across = 0;
  std::vector<float> questions; // class, change and weight before of each tile
  std::vector<choice::TileToSelect> tiles;
};

Tiles random_tiles(uint32_t width, uint32_t height, bool continues) {
  Tiles out{width, height, static_cast<uint32_t>(ceil_div(width, tile_side)), {}, {}};
  std::mt19937 random(width);
  for (uint64_t i = 0; i < tile_count(width, height); ++i) {
    const uint32_t type = random() % 4;
    // Few different changes, so that the last bin has tiles of many groups.
    const uint32_t change = 1u << random() % 12;
    const uint32_t weight = random() % 3 == 0 ? random() % (choice::full_tile_weight + 1) : 0;
    const uint32_t before = type == 1 ? weight : choice::not_scattering;
    for (const uint32_t value : {type, change, before, 0u})
      out.questions.push_back(static_cast<float>(value));
    out.tiles.push_back({type == 1, change, continues ? before : 0});
  }
  return out;
}

class SelectedTiles : public testing::BufferGraphTest {
protected:
  void expect_selection(const Tiles& tiles, uint32_t units, bool continues) {
    SCOPED_TRACE(
        fmt::format("{}x{}, {} units, continues {}", tiles.width, tiles.height, units, continues));
    testing::BufferGraph input{tiles.width, tiles.height};
    input.rows = static_cast<uint32_t>(ceil_div(tiles.tiles.size() + 1, answer_columns));
    input.text = graph_text(input.rows, continues);
    input.questions = tiles.questions;
    input.sample_units = units;
    input.own = testing::list_pass_types(input_ports, output_ports);
    testing::BufferGraphAnswers answers;
    run_graph(input, answers);
    if (HasFatalFailure()) return;
    const choice::TileSelection expected = choice::select_tiles(tiles.tiles, units, continues);
    std::vector<uint32_t> weights, expected_tiles;
    for (uint32_t i = 0; i < tiles.tiles.size(); ++i) {
      weights.push_back(answers.texels[i][0]);
      if (expected.weights[i] == 0 || expected.weights[i] == choice::not_scattering) continue;
      expected_tiles.push_back(i % tiles.across | (i / tiles.across) << 15);
    }
    EXPECT_TRUE(weights == expected.weights);
    testing::expect_list(answers, 1, expected_tiles);
    testing::expect_arguments(answers, expected_tiles.size());
    EXPECT_EQ(answers.counters.sample_units, expected.units);
    EXPECT_EQ(answers.counters.sample_demand, expected.demand);
  }
};

TEST_F(SelectedTiles, EqualTheRuleOnTheCpu) {
  for (const auto& [width, height] : {std::pair{9u, 7u}, {641u, 363u}, {2560u, 1440u}})
    for (const bool continues : {true, false}) {
      const Tiles tiles = random_tiles(width, height, continues);
      const uint32_t demand = choice::select_tiles(tiles.tiles, 0, continues).demand;
      for (const uint32_t units : {0u, demand / 7, demand / 2, demand - 1, UINT32_MAX})
        expect_selection(tiles, units, continues);
    }
}

} // namespace
} // namespace dermis::subsurface::selected_tiles
