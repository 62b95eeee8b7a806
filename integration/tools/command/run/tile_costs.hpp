#pragma once
// What tiles of each class cost in texel reads: T'(n) = sum of w S(m) + O(n) of the papers, for graphs that
// give tiles samples. w: tiles of a class, S(m): reads a pixel at m samples, M(d): reads a sample.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct TileClass {
  uint32_t samples = 0; // m, a pixel
  uint64_t tiles = 0;   // w
  double reads = 0;     // S(m), texels a pixel
};

struct TileCosts {
  std::vector<TileClass> classes; // those without samples first; empty: the graph gives tiles no samples
  double reads_per_sample = 0;    // M(d)
  double reads_beside = 0;        // O(n): of passes over the whole view, texels
  double total() const;           // T'(n), texels
};

// Of a frame that ran `choice.outcome` of the graph. `settings`: given by the caller with --set. Reads are
// counted from the kernels' source (image_reads.hpp), not measured.
TileCosts tile_costs(const LoadedGraph& loaded, const Size& size, std::span<const NamedValue> settings,
                     const demo::FrameChoice& choice);
// Lines for people; "" where there are no classes.
std::string describe_tile_costs(const TileCosts& costs);

} // namespace dermis::tools
