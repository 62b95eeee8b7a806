#pragma once
// Graphs drawn from a seed: valid by construction, with in-place updates, histories, buffers, imports and
// exports, and images of which ports name parts.

#include "tests/framegraph/graph_builder.hpp"

#include <cstdint>

namespace dermis::testing {

enum class Sizes : uint8_t {
  mixed,   // resources take one page of memory up to nine
  one_page // each takes one
};

GraphBuilder random_graph(uint64_t seed, Sizes sizes = Sizes::mixed);

// Lets some passes run after others that stand before them, for no reason of data.
void draw_orders(GraphBuilder& builder, uint64_t seed);

} // namespace dermis::testing
