#pragma once
// What the library chose over a run of frames, and what its histories held, for people and for programs.

#include "framegraph/text/json_writer.hpp"
#include "integration/examples/demo_engine/engine.hpp"
#include "integration/tools/command/run/tile_costs.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

class ChoiceReport {
public:
  // `histories`: after the frame.
  void add(uint32_t frame, const demo::FrameChoice& choice, std::vector<demo::FrameHistory> histories,
           TileCosts costs = {});
  bool empty() const { return frames_.empty(); }

  // "technique=sap: 412 tiles, copied 3, skipped 3,185: 2.10 ms predicted, 2.20 measured, budget 2.50; ...":
  // the newest frame, before it how many frames each outcome had, after it its histories.
  std::string text() const;
  // [{"frame": .., "outcome": .., ..}, ..]
  void write(JsonWriter& writer) const;

private:
  struct Frame {
    uint32_t frame = 0;
    demo::FrameChoice choice;
    std::vector<demo::FrameHistory> histories;
    TileCosts costs;
  };
  std::vector<Frame> frames_;
};

// One sentence about one frame.
std::string describe_choice(const demo::FrameChoice& choice);

} // namespace dermis::tools
