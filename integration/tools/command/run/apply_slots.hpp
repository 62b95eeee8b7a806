#pragma once
// Which image of a captured frame goes into which slot of a graph, and in which format.

#include "framegraph/model/graph.hpp"
#include "integration/tools/files/capture.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

struct SlotData {
  std::string slot;
  std::vector<float> texels; // empty: written by the graph only
  uint32_t channels = 0;
};

struct SlotChoice {
  std::vector<SlotData> data;
  std::vector<std::pair<std::string, Format>> formats;
  std::vector<std::string> unbound;
  std::string problem; // not empty: the graph asks for what the frame has not; nothing else counts
};

// Chooses the most exact format that a slot accepts, so that light which is not scattered comes back as it
// went in.
SlotChoice choose_slots(const Graph& graph, const CapturedFrame& frame);

} // namespace dermis::tools
