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
                                buffer_port("unread", Usage::storage_buffer_write)};
constexpr Port output_ports[] = {buffer_port("tile_states", Usage::storage_buffer_read),
                                 buffer_port("tiles", Usage::storage_buffer_read),
                                 buffer_port("arguments", Usage::storage_buffer_read),
                                 testing::answers_port};

std::string graph_text(uint32_t rows) {
  return fmt::format(
      R"({{ "dermis": 2, "name": "selection",
  "resources": {{
    "classes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "list_state": {{ "buffer": {{ "stride": 4, "count": "view/64", "extra": 8 }} }},
    "tile_changes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "unread": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "histogram": {{ "buffer": {{ "stride": 2048, "count": "view/256" }} }},
    "tile_states": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "tiles": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
    "answers": {{ "format": "rgba32_uint", "size": [{0}, {1}] }} }},
  "passes": [
    {{ "pass": "input", "type": "test.input", "write": {{ "classes": "classes",
      "list_state": "list_state", "tile_changes": "tile_changes", "unread": "unread" }} }},
    {{ "pass": "histogram", "type": "subsurface.tile_histogram",
      "read": {{ "classes": "classes", "tile_changes": "tile_changes" }},
      "write": {{ "histogram": "histogram" }} }},
    {{ "pass": "select", "type": "subsurface.select_tiles",
      "read": {{ "tile_changes": "tile_changes", "histogram": "histogram" }},
      "write": {{ "classes": "classes", "list_state": "list_state",
                 "tile_states": "tile_states", "selected_tiles": "tiles",
                 "selected_arguments": "arguments" }} }},
    {{ "pass": "output", "type": "test.output",
      "read": {{ "tile_states": "tile_states", "tiles": "tiles", "arguments": "arguments" }},
      "write": {{ "target": "answers" }} }} ],
  "exports": ["answers"] }})",
      answer_columns, rows);
}

struct Tiles {
  uint32_t width = 0, height = 0, across = 0;
  std::vector<float> questions; // class and priority of each tile
  std::vector<choice::TileToSelect> tiles;
};

// Returns random tiles. One of `kept_of` tiles is kept.
Tiles random_tiles(uint32_t width, uint32_t height, uint32_t kept_of) {
  Tiles out{width, height, static_cast<uint32_t>(ceil_div(width, tile_side)), {}, {}};
  std::mt19937 random(width);
  for (uint64_t i = 0; i < tile_count(width, height); ++i) {
    const uint32_t type = random() % 4;
    // Few different changes, so that the last bin has tiles of many groups. A float holds each
    // with the bit of kept tiles.
    uint32_t priority = 1u << (8 + random() % 12);
    priority |= random() % 8 << choice::selection_level_shift;
    if (random() % kept_of == 0) priority |= choice::selection_kept_bit;
    for (const uint32_t value : {type, priority, 0u, 0u})
      out.questions.push_back(static_cast<float>(value));
    out.tiles.push_back({type == 1, priority});
  }
  return out;
}

class SelectedTiles : public testing::BufferGraphTest {
protected:
  void expect_selection(const Tiles& tiles, uint32_t units) {
    SCOPED_TRACE(fmt::format("{}x{}, {} units", tiles.width, tiles.height, units));
    testing::BufferGraph input{tiles.width, tiles.height};
    input.rows = static_cast<uint32_t>(ceil_div(tiles.tiles.size() + 1, answer_columns));
    input.text = graph_text(input.rows);
    input.questions = tiles.questions;
    input.sample_units = units;
    input.own = testing::list_pass_types(input_ports, output_ports);
    testing::BufferGraphAnswers answers;
    run_graph(input, answers);
    if (HasFatalFailure()) return;
    const choice::TileSelection expected = choice::select_tiles(tiles.tiles, units);
    uint32_t different = 0;
    std::vector<uint32_t> expected_tiles;
    for (uint32_t i = 0; i < tiles.tiles.size(); ++i) {
      const choice::TileState state = expected.states[i];
      const uint32_t level = tiles.tiles[i].scatters
                                 ? tiles.tiles[i].priority >> choice::selection_level_shift & 7
                                 : 0;
      different += answers.texels[i][0] != (static_cast<uint32_t>(state) | level << 8) ? 1 : 0;
      if (state == choice::TileState::shown || state == choice::TileState::fading)
        expected_tiles.push_back(i % tiles.across | (i / tiles.across) << 15);
    }
    EXPECT_EQ(different, 0u);
    EXPECT_EQ(answers.texels[tiles.tiles.size()][0], expected.steady);
    testing::expect_list(answers, 1, expected_tiles);
    testing::expect_arguments(answers, expected_tiles.size());
    EXPECT_EQ(answers.counters.sample_units, expected.units);
    EXPECT_EQ(answers.counters.sample_demand, expected.demand);
  }
};

TEST_F(SelectedTiles, EqualTheRuleOnTheCpu) {
  for (const auto& [width, height] : {std::pair{9u, 7u}, {641u, 363u}, {2560u, 1440u}})
    for (const uint32_t kept_of : {3u, UINT32_MAX}) {
      const Tiles tiles = random_tiles(width, height, kept_of);
      const uint32_t demand = choice::select_tiles(tiles.tiles, 0).demand;
      for (const uint32_t units : {0u, demand / 7, demand / 2, demand - 1, UINT32_MAX})
        expect_selection(tiles, units);
    }
}

} // namespace
} // namespace dermis::subsurface::selected_tiles
