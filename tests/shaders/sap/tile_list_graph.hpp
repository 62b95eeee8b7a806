#pragma once
// Parts that tests of tile lists share: a kernel that fills buffers from a table, one that copies
// lists to an image, and the comparison of a list as a set.
#include "tests/shaders/sap/buffer_graph.hpp"

#include <string_view>

namespace dermis::testing {

constexpr Port buffer_port(std::string_view name, Usage usage) {
  return {name, usage, false, "uint", "", {}};
}
inline constexpr Port answers_port = {"target", Usage::storage_image_write, false, "uimage2D", "",
                                      {}};

// Returns the pass types test.input, which writes four buffers with a word per tile, and
// test.output, which writes three buffers to `answers`.
std::vector<OwnPassType> list_pass_types(std::span<const Port> inputs,
                                         std::span<const Port> outputs);

// Compares a list of tiles in a channel of the answers, below its length, with the expected tiles
// in any order.
void expect_list(const BufferGraphAnswers& answers, size_t channel, std::vector<uint32_t> expected);
// Compares indirect arguments in the third channel with those of a list of this length.
void expect_arguments(const BufferGraphAnswers& answers, size_t length);

} // namespace dermis::testing
