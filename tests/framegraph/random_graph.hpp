#pragma once
// Graphs generated from a seed, valid by construction: with in-place updates, histories, buffers,
// imports, exports, and images whose ports name parts.

#include "tests/framegraph/graph_builder.hpp"

#include <cstdint>

namespace dermis::testing {

enum class Sizes : uint8_t {
  mixed,   // Resources take one to nine pages of memory.
  one_page // Each resource takes one page.
};

GraphBuilder random_graph(uint64_t seed, Sizes sizes = Sizes::mixed);

// Orders some passes after earlier passes of the file without a data dependency.
void draw_orders(GraphBuilder& builder, uint64_t seed);

} // namespace dermis::testing
