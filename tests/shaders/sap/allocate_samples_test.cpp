// Compares the samples that kernels allocate to tiles with choice::allocate_samples, in views whose
// tiles many groups share.
#include "passes/choice/sample_allocation.hpp"
#include "passes/common/dispatch.hpp"
#include "tests/shaders/sap/tile_list_graph.hpp"

#include <fmt/format.h>

#include <random>

namespace dermis::subsurface::allocated_samples {
namespace {

using testing::answer_columns, testing::buffer_port;

constexpr Port input_ports[] = {buffer_port("classes", Usage::storage_buffer_write),
                                buffer_port("list_state", Usage::storage_buffer_write),
                                buffer_port("tile_errors", Usage::storage_buffer_write),
                                buffer_port("before", Usage::storage_buffer_write)};
constexpr Port output_ports[] = {buffer_port("samples_per_tile", Usage::storage_buffer_read),
                                 buffer_port("tiles", Usage::storage_buffer_read),
                                 buffer_port("arguments", Usage::storage_buffer_read),
                                 testing::answers_port};

std::string graph_text(uint32_t rows, bool with_demand) {
  const std::string_view demand_pass = with_demand ? R"(
    { "pass": "demand", "type": "subsurface.sample_demand",
      "read": { "classes": "classes", "tile_errors": "tile_errors", "before": "before" },
      "write": { "demand": "demand" } },)"
                                                   : "";
  const std::string_view demand_buffer = with_demand ? R"(
    "demand": { "buffer": { "stride": 1024, "count": "view/256" } },)"
                                                     : "";
  return fmt::format(
      R"({{ "dermis": 2, "name": "samples",
  "resources": {{ {0}
    "classes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "list_state": {{ "buffer": {{ "stride": 4, "count": "view/64", "extra": 8 }} }},
    "tile_errors": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "before": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "samples_per_tile": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "tiles": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
    "answers": {{ "format": "rgba32_uint", "size": [{1}, {2}] }} }},
  "passes": [
    {{ "pass": "input", "type": "test.input", "write": {{ "classes": "classes",
      "list_state": "list_state", "tile_errors": "tile_errors", "before": "before" }} }}, {3}
    {{ "pass": "allocate", "type": "subsurface.allocate_samples",
      "read": {{ "classes": "classes", "tile_errors": "tile_errors", "before": "before" {4} }},
      "write": {{ "list_state": "list_state", "samples_per_tile": "samples_per_tile",
                 "tiles": "tiles", "arguments": "arguments" }} }},
    {{ "pass": "output", "type": "test.output",
      "read": {{ "samples_per_tile": "samples_per_tile", "tiles": "tiles",
                "arguments": "arguments" }},
      "write": {{ "target": "answers" }} }} ],
  "exports": ["answers"] }})",
      demand_buffer, answer_columns, rows, demand_pass,
      with_demand ? R"(, "demand": "demand")" : "");
}

struct Tiles {
  uint32_t width = 0, height = 0, across = 0;
  std::vector<float> questions; // class, error and earlier steps of each tile
  std::vector<uint32_t> errors, before;
  uint32_t previous_width = 0, previous_height = 0; // 0: no previous camera
};

Tiles random_tiles(uint32_t width, uint32_t height) {
  Tiles tiles{width, height, static_cast<uint32_t>(ceil_div(width, tile_side)), {}, {}, {}, 0, 0};
  std::mt19937 random(width);
  for (uint64_t i = 0; i < tile_count(width, height); ++i) {
    const uint32_t type = random() % 4, before = random() % 4;
    // Few different errors, so that the last bin has tiles of many groups.
    const uint32_t error = random() % 3 == 0 ? 0 : 1u << random() % 12;
    for (const uint32_t value : {type, error, before, 0u})
      tiles.questions.push_back(static_cast<float>(value));
    tiles.errors.push_back(type == 1 ? error : 0);
    tiles.before.push_back(before);
  }
  return tiles;
}

// Sets the size of the previous frame, and finds the earlier steps at each tile's place there.
void resize(Tiles& tiles, uint32_t previous_width, uint32_t previous_height) {
  tiles.previous_width = previous_width;
  tiles.previous_height = previous_height;
  const auto previous_across = static_cast<uint32_t>(ceil_div(previous_width, tile_side));
  const auto rows = static_cast<double>(ceil_div(tiles.height, tile_side)),
             previous_rows = static_cast<double>(ceil_div(previous_height, tile_side));
  const std::vector<uint32_t> stored = tiles.before;
  for (uint32_t i = 0; i < stored.size(); ++i) {
    const double x = (i % tiles.across + 0.5) * previous_across / tiles.across,
                 y = (i / tiles.across + 0.5) * previous_rows / rows;
    tiles.before[i] = stored[uint32_t(y) * previous_across + uint32_t(x)];
  }
}

class AllocatedSamples : public testing::BufferGraphTest {
protected:
  void expect_allocation(const Tiles& tiles, uint32_t units, bool with_demand) {
    SCOPED_TRACE(
        fmt::format("{}x{}, {} units, demand {}", tiles.width, tiles.height, units, with_demand));
    testing::BufferGraph input{tiles.width, tiles.height};
    input.rows = static_cast<uint32_t>(ceil_div(tiles.errors.size() + 1, answer_columns));
    input.text = graph_text(input.rows, with_demand);
    input.questions = tiles.questions;
    input.sample_units = units;
    input.previous_width = tiles.previous_width;
    input.previous_height = tiles.previous_height;
    input.own = testing::list_pass_types(input_ports, output_ports);
    testing::BufferGraphAnswers answers;
    run_graph(input, answers);
    if (HasFatalFailure()) return;
    const choice::SampleAllocation expected =
        choice::allocate_samples(tiles.errors, tiles.before, units);
    std::vector<uint32_t> steps, expected_tiles;
    std::array<uint32_t, choice::allocation_steps> by_steps{};
    for (uint32_t i = 0; i < tiles.errors.size(); ++i) {
      steps.push_back(answers.texels[i][0]);
      if (expected.steps[i] == 0) continue;
      expected_tiles.push_back(i % tiles.across | (i / tiles.across) << 15);
      ++by_steps[expected.steps[i] - 1];
    }
    EXPECT_TRUE(steps == expected.steps);
    testing::expect_list(answers, 1, expected_tiles);
    testing::expect_arguments(answers, expected_tiles.size());
    EXPECT_EQ(answers.counters.sample_units, expected.units);
    EXPECT_EQ(answers.counters.sample_demand, expected.demand);
    EXPECT_EQ(answers.counters.sampled_tiles, by_steps);
  }
};

TEST_F(AllocatedSamples, EqualTheRuleOnTheCpu) {
  for (const auto& [width, height] : {std::pair{9u, 7u}, {641u, 363u}, {2560u, 1440u}}) {
    const Tiles tiles = random_tiles(width, height);
    const uint32_t demand = choice::allocate_samples(tiles.errors, tiles.before, 0).demand;
    for (const uint32_t units : {0u, demand / 7, demand / 2, demand - 1, UINT32_MAX})
      expect_allocation(tiles, units, true);
  }
}

TEST_F(AllocatedSamples, OtherSize_KeepsTheSamplesOfTheNearestTile) {
  for (const auto& [width, height] :
       {std::pair{641u, 363u}, {632u, 363u}, {641u, 300u}, {97u, 55u}}) {
    Tiles tiles = random_tiles(641, 363);
    resize(tiles, width, height);
    const uint32_t demand = choice::allocate_samples(tiles.errors, tiles.before, 0).demand;
    for (const bool with_demand : {true, false})
      expect_allocation(tiles, demand / 3, with_demand);
  }
}

TEST_F(AllocatedSamples, WithoutSummedDemand_EqualTheRuleOnTheCpu) {
  const Tiles tiles = random_tiles(641, 363);
  const uint32_t demand = choice::allocate_samples(tiles.errors, tiles.before, 0).demand;
  for (const uint32_t units : {demand / 3, UINT32_MAX})
    expect_allocation(tiles, units, false);
}

} // namespace
} // namespace dermis::subsurface::allocated_samples
