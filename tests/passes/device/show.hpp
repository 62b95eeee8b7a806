#pragma once
// What the host shows a graph, frame by frame: pictures by slot, rectangles, cuts. Drawn from a seed, or
// always the same.

#include "framegraph/model/graph.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace dermis::testing {

struct ShownFrame {
  uint32_t x = 0, y = 0, width = 0, height = 0;       // pixels of the view that are rendered
  bool cut = false;                                   // histories start anew
  std::map<std::string, std::vector<float>> pictures; // by import: its channels a pixel, row by row
};

struct Show {
  uint32_t width = 0, height = 0; // of the view, pixels
  std::vector<bool> bound;        // by resource, as CompileInput::bound
  std::vector<Format> formats;    // by resource, as CompileInput::host_formats
  std::vector<ShownFrame> frames;
};

// Views of 16 to 48 pixels a side, of any surfaces and light that the soak draws, damaged light among it;
// some optional slots are left out.
Show random_show(uint64_t seed, const Graph& graph);
// 64x48 pixels, 6 frames: a ball before a step, two profiles, noisy light that moves. Imports are bound, and
// of what a graph hands out the light.
Show golden_show(const Graph& graph);

// Channels of pictures of an import of this name.
uint32_t shown_channels(const std::string& import);

} // namespace dermis::testing
