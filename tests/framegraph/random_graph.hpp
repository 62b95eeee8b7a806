#pragma once
// Graphs drawn from a seed: valid by construction, with in-place updates, histories, buffers, imports and
// exports, and images of which ports name parts.

#include "tests/framegraph/graph_builder.hpp"

#include <cstdint>

namespace dermis::testing {

GraphBuilder random_graph(uint64_t seed);

} // namespace dermis::testing
