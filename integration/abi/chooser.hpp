#pragma once
// Holds the library's choice for one view of a graph: cost and error models, decisions for recent
// frames, and their measured configurations.

#include "framegraph/vulkan/executor.hpp"
#include "integration/include/dermis/dermis.h"
#include "passes/choice/budget_controller.hpp"
#include "passes/choice/budget_division.hpp"
#include "passes/choice/calibration.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/choice/defaults.hpp"
#include "passes/choice/error_correction.hpp"
#include "passes/choice/sample_allocation.hpp"
#include "passes/choice/sample_demand.hpp"
#include "passes/choice/tile_growth.hpp"
#include "passes/choice/time_margin.hpp"
#include "passes/common/dispatch.hpp"
#include "passes/common/environment.hpp"

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace dermis::abi {

struct CompiledGraph;

inline uint64_t tiles_of(const vulkan::Rectangle& rectangle) {
  return subsurface::tile_count(rectangle.width, rectangle.height);
}

// Frames in a row of one technique, without a cut.
struct TechniqueRun {
  int32_t technique = -2; // that the error correction observes; -2: none
  uint32_t frames = 0;    // before the present one
  bool known = false;     // its error was known in the first frame
};

// A recorded frame: its forecast and, once the device has finished the frame, its measurements.
struct FrameChoice {
  uint64_t frame_index = 0;    // 0: none
  uint64_t compiled_graph = 0; // CompiledGraph::serial
  uint64_t revision = 0;       // CompiledGraph::revision
  uint32_t configuration = 0;  // into CompiledGraph::configurations
  // into CompiledGraph::plans: the configuration's plan, or its replacement for empty bounds
  uint32_t plan = 0;
  choice::Decision decision;
  uint32_t switches = 0; // since the graph was created
  double budget_ms = 0;  // 0: no budget
  vulkan::Rectangle rectangle;
  // First frame after a switch of the configuration. Excluded from estimates: drivers finish
  // compiling kernels on first use, caches are cold, and histories begin.
  bool begins = false;
  bool fading = false;   // weights of selected tiles may still change
  bool left_out = false; // empty bounds: passes that serve scattering did not run
  bool history_invalid = false;
  bool history_unread = false; // also if only the previous camera is unusable
  bool cut = false;
  uint64_t expected_tiles = 0;        // number of tiles that the forecast assumed
  uint32_t sample_units = UINT32_MAX; // limit on the samples of tiles
  TechniqueRun run;
  bool converging = false; // histories began so recently that the error is not the technique's
  bool probed = false;     // whatever the interval between probed frames
  bool observed = false;
  bool timed = false;
  double measured_ms = 0;   // valid if `timed`
  double calibrated_ms = 0; // cost by the calibration only, for the counted work
  uint32_t dispatches = 0;
  uint64_t groups = 0; // launched by the dispatches
  subsurface::FrameCounters counters;
};

// Tells when the weights of selected tiles are final: at once after a switch of the configuration,
// and a few frames after a change of the number of tiles.
struct SelectionChange {
  double units = 0;             // of samples or tiles in the frame
  uint32_t frames_to_final = 0; // 0: final
};

// Values of choose() for one frame.
struct ChoiceScratch {
  std::vector<choice::Forecast> forecasts; // by configuration
  std::vector<choice::Assessment> assessments;
  choice::DecisionState state; // becomes Chooser::state by remember()
};

inline constexpr float largest_budget_ms = 1e6f;

// The values of dermis_budget without its tables.
struct Budget {
  double ms = 0;              // 0: choices keep their defaults
  bool deterministic = false; // DERMIS_BUDGET_DETERMINISTIC
  double percentile = 0.95;
  choice::Trials trials = choice::Trials::on;
  bool all_views = false; // DERMIS_BUDGET_ALL_VIEWS
};

// The division of a budget among the views of a graph. `mutex` guards it and all shares; it is
// locked after the mutex of a view.
struct SharedBudget {
  std::mutex mutex;
  choice::BudgetDivision division;
};

struct Chooser {
  choice::ErrorModel errors;
  choice::Calibration calibration; // initial values of `costs`
  choice::CostEstimator costs;
  choice::ErrorCorrection error_correction; // measured by the error probe; corrects `errors`
  Budget budget;
  choice::DecisionState state;
  choice::DecisionState previous_state; // before the last remember()
  uint64_t decided_for = 0;             // CompiledGraph::serial that `state` belongs to
  uint64_t previously_decided_for = 0;
  subsurface::FrameCounters counters;  // of the newest observed frame
  vulkan::Rectangle counted_rectangle; // of the same frame
  bool counted = false;
  // Light that is off for a moment changes no expected error: transmitted light counts until none
  // was seen for a second, d and relief are those of the newest frame in which tiles scattered.
  double transmitted_rms = 0, transmitted_s = 0; // of the newest frame with any; its clock
  choice::FrameKey scattering_key;
  vulkan::Rectangle scattering_rectangle; // width 0: no such frame
  choice::TileGrowth tile_growth;         // of tiles with subsurface
  // of tiles that get samples individually
  choice::SampleDemand demand;
  double last_margin = choice::first_margin;                        // of the frame observed last
  std::array<FrameChoice, vulkan::max_frames_in_flight + 2> frames; // by frame_index
  FrameChoice newest;                                               // the newest observed frame
  SelectionChange selection, previous_selection; // of the newest recorded frame; before it
  TechniqueRun run, previous_run;                // the same
  // number of compiled graphs adopted so far
  uint64_t compiled_graphs = 0;
  // Preallocated by adopt(), so that recording allocates nothing.
  std::vector<vulkan::PassTiming> times;
  std::vector<choice::PassTime> pass_times;
  ChoiceScratch scratch;
};

// Returns the class of a device whose costs a chooser starts from. Only discrete GPUs are large.
choice::DeviceClass device_class(VkPhysicalDeviceType type);
// Returns a chooser with the library's built-in tables.
Chooser make_chooser(choice::DeviceClass device);

// Prepares a compiled graph for this chooser: allocates everything that deciding and observing
// need. Must be called before the compiled graph's first record.
void adopt(Chooser& chooser, const PassTypeRegistry& pass_types, CompiledGraph& compiled_graph);
// Leaves out work that this compiled graph no longer runs, such as that of earlier setting values,
// from forecasts and from the number of trials. Call it after the configurations change.
void retire_other_costs(Chooser& chooser, const CompiledGraph& compiled_graph) noexcept;

// Learns from frames of `compiled_graph` that the device has finished. Allocates nothing.
void observe(Chooser& chooser, CompiledGraph& compiled_graph,
             uint64_t completed_frame_index) noexcept;

// A frame as the choice sees it.
struct FrameRequest {
  uint64_t index = 0;
  double seconds = 0; // since the previous frame; 0: unknown
  bool cut = false;
  bool empty_bounds = false; // nothing runs
  vulkan::Rectangle rectangle;
  SharedBudget* shared = nullptr; // of the graph
  choice::ViewShare* share = nullptr;
};
// Returns the choice for a frame. Call remember() once the frame is recorded. Allocates nothing and
// changes no decision or estimate.
FrameChoice choose(Chooser& chooser, const CompiledGraph& compiled_graph,
                   const FrameRequest& frame) noexcept;
void remember(Chooser& chooser, const FrameChoice& frame) noexcept;
// Returns the forecasts of all configurations for frames that show what was counted last, at the
// resolution of `rectangle`. They live until the next call with this chooser. Allocates nothing.
std::span<const choice::Forecast> forecast(Chooser& chooser, const CompiledGraph& compiled_graph,
                                           const vulkan::Rectangle& rectangle) noexcept;
// Returns the configuration that these forecasts of time and error lead to, as if the hysteresis
// between switches had passed. Changes nothing except `scratch`, and allocates nothing.
choice::Decision settled_decision(Chooser& chooser, const CompiledGraph& compiled_graph,
                                  std::span<const choice::Forecast> forecasts,
                                  double budget_ms) noexcept;
// Forgets the frame remembered last, which was never submitted: nothing is learned from it, and
// decisions continue as before it.
void discard_choice(Chooser& chooser, uint64_t frame_index) noexcept;

} // namespace dermis::abi
