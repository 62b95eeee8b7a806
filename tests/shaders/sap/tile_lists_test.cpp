// Compares the lists of tiles that kernels make of synthetic tile classes with list_sap_tiles, as
// sets: the order of a list varies.
#include "passes/common/dispatch.hpp"
#include "tests/passes/sap/cpu/tile_lists.hpp"
#include "tests/shaders/sap/buffer_graph.hpp"

#include "test_tile_classes.spv.h"
#include "test_tile_lists.spv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <random>

namespace dermis::subsurface::tile_lists {
namespace {

using testing::answer_columns;
using vulkan::KernelShape;
using Texel = testing::BufferTexel;

constexpr uint32_t scatters = 1, copies = 2, full_bit = 4;
constexpr uint32_t groups_per_row = 32768;

constexpr Port classes_ports[] = {
    {"classes", Usage::storage_buffer_write, false, "uint", "", {}},
    {"list_state", Usage::storage_buffer_write, false, "uint", "", {}}};
constexpr Port read_buffer(std::string_view name, bool optional = false) {
  return {name, Usage::storage_buffer_read, optional, "uint", "", {}};
}
constexpr Port lists_ports[] = {read_buffer("level_tiles"),
                                read_buffer("level_arguments"),
                                read_buffer("tiles"),
                                read_buffer("arguments"),
                                read_buffer("copy_arguments", true),
                                read_buffer("plain_tiles"),
                                read_buffer("plain_arguments"),
                                {"target", Usage::storage_image_write, false, "uimage2D", "", {}}};

struct View {
  uint32_t width = 0, height = 0;
  PixelGrid grid = 0;
  uint32_t across() const { return static_cast<uint32_t>(ceil_div(width, tile_side)); }
  uint32_t down() const { return static_cast<uint32_t>(ceil_div(height, tile_side)); }
};

// Both lists in one graph: the second one relies on the state that the first one leaves.
std::string graph_text(uint32_t rows, bool with_copies) {
  const std::string_view copy_write = with_copies ? R"(, "copy_arguments": "copy_arguments")" : "";
  const std::string_view copy_resource =
      with_copies ? R"("copy_arguments": { "buffer": { "stride": 4, "count": [4, 1] } },)" : "";
  return fmt::format(
      R"({{ "dermis": 2, "name": "lists",
  "resources": {{
    "classes": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "list_state": {{ "buffer": {{ "stride": 4, "count": "square_view/64", "extra": 8 }} }},
    "tiles": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
    "plain_tiles": {{ "buffer": {{ "stride": 4, "count": "view/8", "extra": 1 }} }},
    "plain_arguments": {{ "buffer": {{ "stride": 4, "count": [4, 1] }} }},
    "level_tiles": {{ "buffer": {{ "stride": 16, "count": "square_view/8", "extra": 64 }} }},
    "level_arguments": {{ "buffer": {{ "stride": 16, "count": [9, 1] }} }}, {0}
    "answers": {{ "format": "rgba32_uint", "size": [{1}, {2}] }} }},
  "passes": [
    {{ "pass": "classes", "type": "test.classes",
      "write": {{ "classes": "classes", "list_state": "list_state" }} }},
    {{ "pass": "levels", "type": "subsurface.sap_tiles", "read": {{ "classes": "classes" }},
      "write": {{ "list_state": "list_state", "level_tiles": "level_tiles", "tiles": "tiles",
                 "level_arguments": "level_arguments", "arguments": "arguments" {3} }} }},
    {{ "pass": "plain", "type": "subsurface.tile_list", "read": {{ "classes": "classes" }},
      "write": {{ "list_state": "list_state", "tiles": "plain_tiles",
                 "arguments": "plain_arguments" }} }},
    {{ "pass": "lists", "type": "test.lists",
      "read": {{ "level_tiles": "level_tiles", "level_arguments": "level_arguments",
                "tiles": "tiles", "arguments": "arguments", "plain_tiles": "plain_tiles",
                "plain_arguments": "plain_arguments" {3} }},
      "write": {{ "target": "answers" }} }} ],
  "exports": ["answers"] }})",
      copy_resource, answer_columns, rows, copy_write);
}

struct Answers {
  std::vector<Texel> arguments, lists;
  FrameCounters counters;
};

class TileLists : public testing::BufferGraphTest {
protected:
  // Runs both list kernels on classes of the tiles of a view.
  void run(View view, const std::vector<uint32_t>& classes, bool with_copies, KernelShape shape,
           Answers& answers) {
    testing::BufferGraph input{view.width, view.height, view.grid};
    input.rows = static_cast<uint32_t>(1 + ceil_div(8 * (classes.size() + 64), answer_columns));
    input.text = graph_text(input.rows, with_copies);
    input.questions.assign(classes.begin(), classes.end());
    input.shape = shape;
    input.own = {
        {{"test.classes", "classes", "", classes_ports, {}, over_tile_grid},
         test_tile_classes_spirv},
        {{"test.lists", "lists", "", lists_ports, {}, over_written_image}, test_tile_lists_spirv}};
    testing::BufferGraphAnswers found;
    run_graph(input, found);
    if (HasFatalFailure()) return;
    answers.arguments.assign(found.texels.begin(), found.texels.begin() + answer_columns);
    answers.lists.assign(found.texels.begin() + answer_columns, found.texels.end());
    answers.counters = found.counters;
  }
};

uint32_t place_of(const SapTile& tile, uint32_t entry) {
  const uint32_t copy = (entry & 3) == scatters ? 0 : 1u << 31;
  const uint32_t full = (entry & full_bit) != 0 ? 1u << 30 : 0;
  return tile.x | tile.y << 15 | copy | full;
}

using Entry = std::array<uint32_t, 2>;

// Returns `count` entries of a list in a fixed order.
std::vector<Entry> sorted_entries(const std::vector<Texel>& lists, size_t first, size_t count) {
  std::vector<Entry> entries;
  for (size_t i = first; i < first + count; ++i)
    entries.push_back({lists.at(i)[0], lists.at(i)[1]});
  std::sort(entries.begin(), entries.end());
  return entries;
}
std::vector<uint32_t> sorted_tiles(const std::vector<Texel>& lists, size_t channel) {
  std::vector<uint32_t> tiles;
  for (size_t i = 1; i <= lists[0][channel]; ++i)
    tiles.push_back(lists.at(i)[channel]);
  std::sort(tiles.begin(), tiles.end());
  return tiles;
}

void expect_groups(const std::vector<Texel>& arguments, size_t first, size_t channel,
                   uint32_t groups) {
  EXPECT_EQ(arguments[first][channel], std::min(groups, groups_per_row));
  EXPECT_EQ(arguments[first + 1][channel], ceil_div(groups, groups_per_row));
  EXPECT_EQ(arguments[first + 2][channel], 1u);
}

void expect_lists(View view, const std::vector<uint32_t>& classes, bool with_copies, bool texels,
                  const Answers& answers) {
  std::vector<uint32_t> types;
  for (const uint32_t entry : classes)
    types.push_back(entry & 3);
  const bool any = std::find(types.begin(), types.end(), scatters) != types.end();
  const auto lists = list_sap_tiles(view.width, view.height, types, view.grid);
  size_t first = sap_level_count;
  for (size_t level = 0; level < lists.size(); ++level) {
    const SapTileList& list = lists[level];
    SCOPED_TRACE(fmt::format("level {}", level));
    std::vector<Entry> expected;
    for (const SapTile& tile : list.tiles) {
      const uint32_t entry = classes[level == 0 ? size_t{tile.y} * view.across() + tile.x : 0];
      expected.push_back({level == 0 ? place_of(tile, entry) : tile.x | tile.y << 15,
                          tile.children | tile.around << 9});
    }
    std::sort(expected.begin(), expected.end());
    if (!any && with_copies) expected.clear();
    ASSERT_EQ(answers.lists[level][0], first);
    ASSERT_EQ(answers.lists[level][1], expected.size());
    EXPECT_TRUE(sorted_entries(answers.lists, first, expected.size()) == expected);
    first += size_t{list.across} * list.down;
    const auto groups = texels ? static_cast<uint32_t>(expected.size())
                               : (expected.empty() ? 0 : list.groups(level));
    expect_groups(answers.arguments, 4 * level, 0, groups);
    EXPECT_EQ(answers.arguments[4 * level + 3][0], groups);
    EXPECT_EQ(answers.counters.level_groups[level], groups);
  }
  std::vector<uint32_t> tiles;
  for (const SapTile& tile : lists[0].tiles)
    tiles.push_back(place_of(tile, classes[size_t{tile.y} * view.across() + tile.x]));
  std::sort(tiles.begin(), tiles.end());
  EXPECT_TRUE(sorted_tiles(answers.lists, 2) == tiles);
  EXPECT_TRUE(sorted_tiles(answers.lists, 3) == tiles) << "tile_list";
  const auto count = static_cast<uint32_t>(tiles.size());
  expect_groups(answers.arguments, 0, 1, count);
  expect_groups(answers.arguments, 0, 3, count);
  if (with_copies) {
    EXPECT_EQ(answers.arguments[0][2], any ? 0 : std::min(count, groups_per_row));
    EXPECT_EQ(answers.arguments[1][2], ceil_div(count, groups_per_row));
  }
}

// Returns classes of a disc that covers half of the view, and of single tiles outside.
std::vector<uint32_t> mixed_classes(View view) {
  std::mt19937 random(view.width + view.height);
  std::vector<uint32_t> classes;
  for (uint32_t y = 0; y < view.down(); ++y)
    for (uint32_t x = 0; x < view.across(); ++x) {
      const double u = (x + 0.5) / view.across() - 0.5, v = (y + 0.5) / view.down() - 0.5;
      const bool inside = u * u + v * v < 0.16 || random() % 64 == 0;
      classes.push_back(inside ? 1 + random() % 3 + full_bit * (random() % 2) : 0);
    }
  return classes;
}

TEST_F(TileLists, LargeViews_EqualTheReferenceAsSets) {
  for (const View view : {View{2560, 1440}, {3840, 2160}, {7680, 4320}}) {
    SCOPED_TRACE(fmt::format("{}x{}", view.width, view.height));
    const std::vector<uint32_t> classes = mixed_classes(view);
    Answers answers;
    run(view, classes, true, KernelShape::texel, answers);
    if (HasFatalFailure()) return;
    expect_lists(view, classes, true, true, answers);
  }
}

TEST_F(TileLists, OddSizes_EqualTheReferenceAsSets) {
  for (const View view : {View{1, 1},
                          {9, 7},
                          {112, 113},
                          {128, 128},
                          {130, 66},
                          {257, 1},
                          {333, 187},
                          {1024, 1020},
                          {1921, 1081},
                          {16384, 9},
                          {9, 16384}}) {
    SCOPED_TRACE(fmt::format("{}x{}", view.width, view.height));
    const std::vector<uint32_t> classes = mixed_classes(view);
    Answers answers;
    run(view, classes, true, KernelShape::block, answers);
    if (HasFatalFailure()) return;
    expect_lists(view, classes, true, false, answers);
  }
}

// Levels that do not halve an axis have more tiles along it.
TEST_F(TileLists, PixelsNotSquare_EqualTheReferenceAsSets) {
  for (const double aspect : {1.2, 2.0, 0.5, 4.0, 0.25})
    for (const View view : {View{333, 187}, {1024, 1020}, {16384, 9}, {9, 16384}}) {
      SCOPED_TRACE(fmt::format("{}x{}, aspect {}", view.width, view.height, aspect));
      const View shaped{view.width, view.height, pixel_grid(aspect)};
      const std::vector<uint32_t> classes = mixed_classes(shaped);
      const bool texels = view.width != 333;
      Answers answers;
      run(shaped, classes, true, texels ? KernelShape::texel : KernelShape::block, answers);
      if (HasFatalFailure()) return;
      expect_lists(shaped, classes, true, texels, answers);
    }
}

// Columns of tiles that level 4 reduces to one column each, at all places of words of flags.
TEST_F(TileLists, SparseColumns_EqualTheReferenceAsSets) {
  constexpr View view{16384, 512};
  for (uint32_t offset = 0; offset < 96; offset += 16) {
    SCOPED_TRACE(offset);
    std::vector<uint32_t> classes(size_t{view.across()} * view.down());
    for (uint32_t i = 0; i < classes.size(); ++i)
      classes[i] = i % view.across() % 96 == offset ? scatters : 0;
    Answers answers;
    run(view, classes, true, KernelShape::texel, answers);
    if (HasFatalFailure()) return;
    expect_lists(view, classes, true, true, answers);
  }
}

TEST_F(TileLists, EqualClasses_EqualTheReferenceAsSets) {
  constexpr View view{1290, 722};
  for (const uint32_t entry : {0u, scatters, scatters | full_bit, copies, 3u})
    for (const bool with_copies : {false, true}) {
      SCOPED_TRACE(fmt::format("class {}, copies {}", entry, with_copies));
      const std::vector<uint32_t> classes(size_t{view.across()} * view.down(), entry);
      Answers answers;
      run(view, classes, with_copies, KernelShape::texel, answers);
      if (HasFatalFailure()) return;
      expect_lists(view, classes, with_copies, true, answers);
    }
}

} // namespace
} // namespace dermis::subsurface::tile_lists
