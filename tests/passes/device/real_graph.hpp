#pragma once
// Graphs of the real pass types drawn from a seed: one to three shipped graphs in one file, each with
// settings, orders and light of its own.

#include "framegraph/model/graph.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis::testing {

struct RealGraph {
  std::string name; // of the shipped graphs that it was made of: "sap+burley"
  std::string text; // JSON, for whoever wants to run it by hand
  Graph graph;
};

// Names of configs/graphs without ".json", sorted, but for graphs that import buffers or a scene: no picture
// stands for those.
std::vector<std::string> graphs_of_images();
// As it ships, with the defaults of its settings. nullopt: the test has failed.
std::optional<RealGraph> shipped_graph(const std::string& name, const PassTypeRegistry& pass_types);
// The first part keeps its names, those of the others begin with "p1_", "p2_". They share imports, and the
// host's light: what one part leaves there the next one scatters again; some take light that an earlier one
// hands out. Samples are few, for slow drivers. nullopt: the test has failed.
std::optional<RealGraph> random_real_graph(uint64_t seed, const PassTypeRegistry& pass_types);

} // namespace dermis::testing
