// Compares the lists of subsurface.separable_tiles with the rule on the CPU, as sets.
#include "passes/common/dispatch.hpp"
#include "passes/separable/separable_kernel.hpp"
#include "tests/shaders/sap/tile_list_graph.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <random>

namespace dermis::subsurface::separable_tiles {
namespace {

using testing::answer_columns, testing::buffer_port;

constexpr Port input_ports[] = {buffer_port("classes", Usage::storage_buffer_write),
                                buffer_port("list_state", Usage::storage_buffer_write),
                                buffer_port("samples_per_tile", Usage::storage_buffer_write),
                                buffer_port("tile_d", Usage::storage_buffer_write)};
constexpr Port output_ports[] = {buffer_port("vertical", Usage::storage_buffer_read),
                                 buffer_port("horizontal", Usage::storage_buffer_read),
                                 buffer_port("arguments", Usage::storage_buffer_read),
                                 testing::answers_port};

std::string graph_text(uint32_t rows) {
  return fmt::format(
      R"({{ "dermis": 2, "name": "separable_tiles",
  "resources": {{
    "classes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "list_state": {{ "buffer": {{ "stride": 4, "count": "view/64", "extra": 8 }} }},
    "samples": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "tile_d": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "needed": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "vertical": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "vertical_arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
    "horizontal": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "horizontal_arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
    "answers": {{ "format": "rgba32_uint", "size": [{0}, {1}] }} }},
  "passes": [
    {{ "pass": "input", "type": "test.input", "write": {{ "classes": "classes",
      "list_state": "list_state", "samples_per_tile": "samples", "tile_d": "tile_d" }} }},
    {{ "pass": "clear_needed", "type": "clear", "write": {{ "target": "needed" }} }},
    {{ "pass": "tiles", "type": "subsurface.separable_tiles",
      "read": {{ "classes": "classes", "samples_per_tile": "samples", "tile_d": "tile_d" }},
      "write": {{ "needed": "needed", "list_state": "list_state", "vertical_tiles": "vertical",
                 "vertical_arguments": "vertical_arguments", "horizontal_tiles": "horizontal",
                 "horizontal_arguments": "horizontal_arguments" }},
      "set": {{ "taps": "17" }} }},
    {{ "pass": "output", "type": "test.output",
      "read": {{ "vertical": "vertical", "horizontal": "horizontal",
                "arguments": "horizontal_arguments" }},
      "write": {{ "target": "answers" }} }} ],
  "exports": ["answers"] }})",
      answer_columns, rows);
}

constexpr uint32_t scatters = 1, full_bit = 4; // of tile_packing.glsl

struct Tile {
  uint32_t entry = 0, samples = 0;
  float d_px = 0;
  uint32_t type() const { return entry & 3; }
};

struct View {
  int32_t width = 0, height = 0; // tiles
  std::vector<Tile> tiles;

  const Tile& at(int32_t x, int32_t y) const {
    return tiles[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
  // The vertical pass runs in tiles without samples, and where the samples fade out.
  bool runs_vertical(int32_t x, int32_t y) const {
    if (at(x, y).type() == 0) return false;
    bool fades = at(x, y).samples == 0;
    for (int32_t i = 0; i < 9; ++i) {
      const Tile& other =
          at(std::clamp(x + i % 3 - 1, 0, width - 1), std::clamp(y + i / 3 - 1, 0, height - 1));
      fades = fades || (other.samples == 0 && other.type() == scatters);
    }
    return fades;
  }
  uint32_t packed(int32_t x, int32_t y) const {
    const Tile& tile = at(x, y);
    return static_cast<uint32_t>(x) | static_cast<uint32_t>(y) << 15 |
           (tile.type() != scatters ? 0x80000000u : 0) |
           ((tile.entry & full_bit) != 0 ? 0x40000000u : 0);
  }
};

// Blocks of tiles with and without samples, so that many tiles are beyond the other's reach.
View random_view(int32_t width, int32_t height, uint32_t block) {
  View view{width, height, {}};
  std::mt19937 random(block);
  std::vector<uint32_t> blocks(10000);
  for (uint32_t& value : blocks)
    value = static_cast<uint32_t>(random());
  constexpr float ds[] = {0.5f, 2, 4, 10, 20, 48}; // bits that a float holds as an integer
  for (int32_t y = 0; y < height; ++y)
    for (int32_t x = 0; x < width; ++x) {
      const size_t in_block =
          static_cast<uint32_t>(y) / block * 97 + static_cast<uint32_t>(x) / block;
      const uint32_t of_block = blocks[in_block % blocks.size()];
      const uint32_t type = random() % 8 == 0 ? static_cast<uint32_t>(random() % 4) : of_block % 2;
      view.tiles.push_back({type | (random() % 2 == 0 ? full_bit : 0u), of_block / 2 % 3,
                            ds[random() % 16 == 0 ? random() % 6 : of_block / 6 % 6]});
    }
  return view;
}

class SeparableTiles : public testing::BufferGraphTest {
protected:
  void expect_lists(const View& view) {
    SCOPED_TRACE(fmt::format("{}x{} tiles", view.width, view.height));
    std::vector<uint32_t> vertical, horizontal, needed(view.tiles.size());
    testing::BufferGraph input;
    input.width = static_cast<uint32_t>(view.width) * tile_side;
    input.height = static_cast<uint32_t>(view.height) * tile_side;
    for (int32_t y = 0; y < view.height; ++y)
      for (int32_t x = 0; x < view.width; ++x) {
        const Tile& tile = view.at(x, y);
        for (const uint32_t value :
             {tile.entry, tile.samples, std::bit_cast<uint32_t>(tile.d_px), 0u})
          input.questions.push_back(static_cast<float>(value));
        if (!view.runs_vertical(x, y)) continue;
        vertical.push_back(view.packed(x, y));
        const int32_t reach =
            tile.type() != scatters ? 0 : (separable_reach_px(tile.d_px, 17) + 7) / 8;
        for (int32_t row = std::max(y - reach, 0); row <= std::min(y + reach, view.height - 1);
             ++row)
          needed[static_cast<size_t>(row * view.width + x)] = 1;
      }
    for (int32_t y = 0; y < view.height; ++y)
      for (int32_t x = 0; x < view.width; ++x)
        if (needed[static_cast<size_t>(y * view.width + x)] != 0 && view.at(x, y).type() != 0)
          horizontal.push_back(view.packed(x, y));
    input.rows = static_cast<uint32_t>(ceil_div(view.tiles.size() + 1, answer_columns));
    input.text = graph_text(input.rows);
    input.own = testing::list_pass_types(input_ports, output_ports);
    testing::BufferGraphAnswers answers;
    run_graph(input, answers);
    if (HasFatalFailure()) return;
    testing::expect_list(answers, 0, vertical);
    testing::expect_list(answers, 1, horizontal);
    testing::expect_arguments(answers, horizontal.size());
  }
};

TEST_F(SeparableTiles, EqualTheRuleOnTheCpuAsSets) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {37, 90}, {160, 91}, {320, 180}})
    for (const uint32_t block : {1u, 5u, 23u})
      expect_lists(random_view(width, height, block));
}

} // namespace
} // namespace dermis::subsurface::separable_tiles
