#pragma once
// Generates graphs for the benchmarks from a seed, as tests/benchmark/shapes.json describes.

#include "framegraph/model/graph.hpp"
#include "framegraph/text/document.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

struct RandomResource {
  uint32_t percent = 0;
  Format format = Format::undefined;
  Rational scale; // factor on the view
};

struct Shape {
  std::string name;
  enum class Kind : uint8_t { chain, fan, random } kind = Kind::chain;
  Rational readers{2, 3}; // fan: fraction of the passes that read the common source
  uint32_t arity = 3;     // fan: reads per pass of the reduction tree, 2..3
  // for random graphs
  uint32_t max_reads = 3, max_writes = 2, unread_percent = 80, window = 32, dead_percent = 0;
};

struct ShapeFile {
  uint32_t view_width = 0, view_height = 0;
  std::vector<RandomResource> resources;
  std::vector<Shape> shapes;
};

// Returns nullopt with errors in `diagnostics`.
std::optional<ShapeFile> read_shapes(const std::string& path, Diagnostics& diagnostics);

// Returns the pass types of generated graphs. Ports a, b, c are read, out and out2 written. Unread
// passes of one type are culled, those of the other never.
PassTypeRegistry benchmark_pass_types();

// Requires `passes` >= 2. Equal arguments give equal graphs on every machine.
Graph draw_graph(const ShapeFile& file, const Shape& shape, uint32_t passes, uint64_t seed);

} // namespace dermis::tools
