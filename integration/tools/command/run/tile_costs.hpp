#pragma once
// Cost of tiles of each class in texel reads, for graphs that allocate samples to tiles: T'(n) =
// sum of w S(m) + O(n) of the papers. w: tiles of a class; S(m): reads per pixel at m samples;
// M(d): reads per sample.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct TileClass {
  uint32_t samples = 0; // m, per pixel
  uint64_t tiles = 0;   // w
  double reads = 0;     // S(m), texels per pixel
};

struct TileCosts {
  // the class without samples first; empty if the graph allocates no samples
  std::vector<TileClass> classes;
  double reads_per_sample = 0; // M(d)
  double reads_per_view = 0;   // O(n): texels read by passes over the whole view
  double total() const;        // T'(n), texels
};

// Returns the costs of a frame that ran `choice.configuration` of the graph. `settings` are those
// of --set. Reads are counted from the kernels' source (image_reads.hpp), not measured.
TileCosts tile_costs(const LoadedGraph& loaded, const Size& size, PixelGrid grid,
                     std::span<const NamedValue> settings, const demo::FrameChoice& choice);
// Formats the costs as text, or "" if there are no classes.
std::string describe_tile_costs(const TileCosts& costs);

} // namespace dermis::tools
