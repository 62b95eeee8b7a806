#pragma once
// Assigns images of a captured frame to slots of a graph, and chooses formats.

#include "framegraph/model/graph.hpp"
#include "integration/tools/files/capture.hpp"

#include <span>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

struct SlotData {
  std::string slot;
  std::vector<float> texels; // empty: only written by the graph
  uint32_t channels = 0;
};

struct SlotChoice {
  std::vector<SlotData> data;
  std::vector<std::pair<std::string, Format>> formats;
  std::vector<std::string> unbound;
  // The frame lacks an image that the graph requires. Other members are then not set. Empty on
  // success.
  std::string problem;
};

// Chooses the most exact format that a slot accepts, so that unscattered light is returned
// unchanged.
SlotChoice choose_slots(const Graph& graph, const CapturedFrame& frame);

} // namespace dermis::tools
