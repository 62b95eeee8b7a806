#pragma once
// Reports the library's choices over a run of frames and the state of the graph's histories, as
// text and as JSON.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/run/tile_costs.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

class ChoiceReport {
public:
  // `histories` is the state after the frame. `frontier`: outcomes to list with the frame.
  void add(uint32_t frame, const demo::FrameChoice& choice,
           std::vector<demo::FrameHistory> histories, TileCosts costs = {},
           std::vector<demo::FrameOutcome> frontier = {});
  bool empty() const { return frames_.empty(); }

  // Returns how many frames used each configuration, the choice of the newest frame, and its
  // histories: "technique=sap: 412 tiles, copied 3, skipped 3,185: 2.10 ms predicted, 2.20
  // measured, budget 2.50; ...".
  std::string text() const;
  // [{"frame": .., "configuration": .., ..}, ..]
  void write(JsonWriter& writer) const;

private:
  struct Frame {
    uint32_t frame = 0;
    demo::FrameChoice choice;
    std::vector<demo::FrameHistory> histories;
    TileCosts costs;
    std::vector<demo::FrameOutcome> frontier;
  };
  std::vector<Frame> frames_;
};

// Describes one frame in one sentence.
std::string describe_choice(const demo::FrameChoice& choice);

} // namespace dermis::tools
