#pragma once
// The inputs that the host gives a graph, frame by frame: pictures by slot, rectangles and cuts;
// randomly generated or fixed.

#include "framegraph/model/graph.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace dermis::testing {

struct ShownFrame {
  uint32_t x = 0, y = 0, width = 0, height = 0;       // Rendered rectangle of the view, in pixels.
  bool cut = false;                                   // Histories restart.
  std::map<std::string, std::vector<float>> pictures; // By import: channels per pixel, row by row.
};

struct Show {
  uint32_t width = 0, height = 0; // Size of the view in pixels.
  std::vector<bool> bound;        // By resource, as CompileInput::bound.
  std::vector<Format> formats;    // By resource, as CompileInput::host_formats.
  std::vector<ShownFrame> frames;
};

// Returns views of 16 to 48 pixels a side with any surfaces and light that the soak generates,
// including damaged light; some optional slots are unbound.
Show random_show(uint64_t seed, const Graph& graph);
// Returns 6 frames of 64x48 pixels: a ball in front of a step, two profiles, and moving noisy
// light. All imports are bound, and of the exports only the light.
Show golden_show(const Graph& graph);

// Returns the channels of pictures of an import with this name.
uint32_t shown_channels(const std::string& import);

} // namespace dermis::testing
