#pragma once
// The library's choice for one view of a graph: what it knows of costs and errors, what it decided for recent
// frames and what became of them.

#include "framegraph/vulkan/executor.hpp"
#include "integration/include/dermis/dermis.h"
#include "passes/choice/calibration.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/choice/controller.hpp"
#include "passes/choice/error_correction.hpp"
#include "passes/choice/sample_allocation.hpp"
#include "passes/choice/sample_demand.hpp"
#include "passes/choice/tile_growth.hpp"
#include "passes/common/environment.hpp"

#include <array>
#include <string>
#include <vector>

namespace dermis::abi {

struct Program;

// A frame that was recorded: what was expected, and once the device has finished it, what was.
struct FrameChoice {
  uint64_t frame_index = 0; // 0: none
  uint64_t program = 0;     // Program::serial
  uint32_t outcome = 0;     // into Program::outcomes
  uint32_t variant =
      0; // into Program::variants: of the outcome, or in its place in a frame with empty bounds
  choice::Decision decision;
  uint32_t switches = 0; // since the graph began
  double budget_ms = 0;  // 0: none
  choice::Forecast forecast;
  uint64_t view_tiles = 0, view_blocks = 0;
  bool first_of_plan =
      false;             // drivers finish kernels when they first run: nothing is learned from such a frame
  bool left_out = false; // its bounds were empty: passes that serve scattering did not run
  bool history_invalid = false;
  uint64_t expected_tiles = 0;        // that the forecast counted on
  uint32_t sample_units = UINT32_MAX; // that tiles may take
  bool observed = false;
  bool timed = false;
  double measured_ms = 0; // where timed
  double metered_ms = 0;  // by the calibration alone, for what was counted
  uint32_t dispatches = 0;
  uint64_t groups = 0; // that these launched
  subsurface::FrameCounters counters;
};

struct Chooser {
  choice::ErrorModel errors;
  choice::Calibration calibration; // costs start from it
  choice::CostModel costs;
  choice::ErrorCorrection found; // by the error probe, beside `errors`
  double budget_ms = 0;          // 0: choices keep their defaults
  bool deterministic = false;    // DERMIS_BUDGET_DETERMINISTIC
  choice::DecisionState state;
  uint64_t decided_for = 0;           // Program::serial that `state` is about
  subsurface::FrameCounters counters; // of the newest observed frame
  bool counted = false;
  choice::TileGrowth trend;    // of tiles with subsurface
  choice::SampleDemand wanted; // of tiles where samples are given by tile
  std::array<FrameChoice, vulkan::max_frames_in_flight + 2> frames; // by frame_index
  FrameChoice newest;                                               // the newest observed frame
  uint64_t programs = 0;                                            // built so far
  // Room, so that recording allocates nothing: see reserve().
  std::vector<choice::Forecast> forecasts;
  std::vector<vulkan::PassTiming> times;
};

// With the tables that the library carries.
Chooser make_chooser();

// Makes a program one of this chooser's: what deciding and observing need is allocated. Before its first
// record.
void adopt(Chooser& chooser, const PassTypeRegistry& pass_types, Program& program);

// Learns from frames of `program` that the device has finished. Allocates nothing.
void observe(Chooser& chooser, Program& program, uint64_t completed_frame_index) noexcept;

// The outcome for frame `frame_index`, whose render rectangle has `view_tiles` tiles and `view_blocks` of
// 4x4, with what is expected of it; `delta_seconds` after the frame before, 0: unknown. Remembered by
// remember() once the frame is recorded. Allocates nothing. Changes `chooser` only through remember().
FrameChoice choose(const Chooser& chooser, const Program& program, uint64_t frame_index, double delta_seconds,
                   uint64_t view_tiles, uint64_t view_blocks, std::span<choice::Forecast> forecasts,
                   choice::DecisionState& state) noexcept;
void remember(Chooser& chooser, const FrameChoice& frame, const choice::DecisionState& state) noexcept;
// The frame was never submitted: nothing will be learned from it.
void forget(Chooser& chooser, uint64_t frame_index) noexcept;

} // namespace dermis::abi
