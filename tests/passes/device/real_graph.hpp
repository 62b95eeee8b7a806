#pragma once
// Random graphs of the real pass types: one to three shipped graphs in one file, each with its own
// settings, order and light.

#include "framegraph/model/graph.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis::testing {

struct RealGraph {
  std::string name; // Names of the shipped graphs it was made of: "sap+burley".
  std::string text; // JSON, to run the graph by hand.
  Graph graph;
};

// Returns the sorted names of configs/graphs without ".json", except graphs that import buffers or
// a scene, which pictures cannot provide.
std::vector<std::string> graphs_of_images();
// Returns the shipped graph with its default settings. On nullopt the test has failed.
std::optional<RealGraph> shipped_graph(const std::string& name, const PassTypeRegistry& pass_types);
// Returns a random graph. The first part keeps its names; names of the others begin with "p1_" and
// "p2_". Parts share imports and the host's light, so a part scatters the result of the part
// before. Some parts take the output light of an earlier part. Sample counts are low for slow
// drivers. On nullopt the test has failed.
std::optional<RealGraph> random_real_graph(uint64_t seed, const PassTypeRegistry& pass_types);

} // namespace dermis::testing
