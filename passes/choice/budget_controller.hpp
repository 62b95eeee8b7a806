#pragma once
// The controller decides which of a graph's configurations runs in the next frame, and how many
// samples it takes: the least expected error whose time fits the budget. Configurations whose time
// is not known are tried if their optimistic time fits. docs/choice.md lists what is guaranteed.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::choice {

// Device time of one configuration in the next frame, in milliseconds, without samples by tile.
struct TimeForecast {
  double calibrated_ms = 0; // by the calibration only; 0: unknown
  double expected_ms = 0;
  double pessimistic_ms = 0; // passes that never ran take more than expected
  double optimistic_ms = 0;  // passes that never ran take their least time
  // in addition, passes that were disturbed when they ran last take their usual time
  double undisturbed_ms = 0;
  double usual_ms = 0;            // only well-known passes that were disturbed do
  double unit_ms = 0;             // of a unit of samples
  double undisturbed_unit_ms = 0; // the same as undisturbed_ms
  bool measured = false;          // all passes were measured recently
};

// Expected result of one configuration (a value for each setting "by": "budget") in the next frame.
struct Forecast {
  TimeForecast time;
  // Logarithm of the factor on the time below which the percentile of frames stays.
  double margin = 0;
  bool takes_samples = false;
  double demand = 0;         // units of samples that tiles request
  double rmse = 0;           // expected error with all requested samples
  double unsampled_rmse = 0; // with none
  // The fraction f of the requested samples leaves (1 - f)^concentration of the difference of the
  // mean squares.
  double concentration = 1;
  double error_frames = 0; // number of probed frames that rmse is known from; 0: the error table
  bool is_probed = true;   // probed frames can tell its error
  // part of rmse: light transmitted through thin parts that the configuration ignores
  double missed_rmse = 0;
};

// Returns the error if tiles take `units` of samples: interpolates the mean square between no
// samples and all samples.
double rmse_with(const Forecast& forecast, double units);

// Returns the budget within which a configuration is entered for certain with `units` of samples.
double needed_budget_ms(const Forecast& forecast, double units);

// When the controller may run a configuration only to measure its time.
enum class Trials : uint8_t {
  on,        // at any time
  cuts_only, // in frames of a cut, in which a change is not visible
  off        // never: the calibration and the device's factor decide
};

enum class ReasonKind : uint8_t {
  no_budget,    // the host gave no budget: the defaults
  first_frame,  // no configuration ran before, or no tile was counted yet
  fits_best,    // the least error that fits; the configuration ran before
  better_fits,  // less error than the previous configuration, and fits
  over_budget,  // the previous configuration does not fit any more
  nothing_fits, // every configuration is over budget: the fastest
  held,         // another one is better by too little, or switches are too frequent
  trial,        // less error than the previous configuration, and might fit
  trial_failed  // the previous configuration was tried and takes too long
};

// One frame as the controller sees it.
struct FrameInput {
  double budget_ms = 0;     // > 0
  double seconds = 0;       // since the last frame; 0: 1/60 s
  bool cut = false;         // a change is not visible in this frame
  bool provisional = false; // tiles were not counted yet: the next decision is free
  Trials trials = Trials::on;
  bool learning = false; // the error of what runs is being measured
  bool idle = false;     // nothing scatters, so errors say nothing: only time may cause a switch
  bool empty = false;    // nothing runs: nothing causes a switch
};

inline constexpr uint32_t no_configuration = UINT32_MAX;
// Number of probed frames from which an error is known well enough to rely on it.
inline constexpr double proven_frames = 8;

struct Decision {
  uint32_t configuration = 0;
  ReasonKind why = ReasonKind::first_frame;
  double units = 0; // of samples that fit, at most the demand
  // units that fit the budget, which may be more than the demand; infinite if they cost nothing
  double max_units = 0;
  double expected_ms = 0, bound_ms = 0; // bound_ms: the percentile of frames stays below
  double rmse = 0;
  // The fastest configuration with less error that does not fit; no_configuration: none.
  uint32_t next_better = no_configuration;
  double missing_ms = 0; // milliseconds by which next_better exceeds the budget
  // Whether another configuration that fits would have less error without transmitted light.
  bool by_transmission = false;
  // Configuration that was left because it took too long: its passes lose optimism.
  uint32_t rejected = no_configuration;
  bool measured = false; // all passes were measured: the frame's time shows whether the margin fits
};

const char* why_text(const Decision& decision); // Returns a static human-readable string.

// Memory of decisions. Plain data: copies are independent histories. A copy into a
// state that had as many configurations allocates nothing.
struct DecisionState {
  struct Configuration {
    double backoff_s = 1;  // time without a trial after the configuration was left
    double left_s = -1e9;  // when it was left over budget
    double left_ratio = 0; // its time over the budget then, or the time expected when it entered
    bool ran = false;
    // how often in a row it took longer than expected when it entered, and was left soon
    uint32_t misjudged = 0;
  };
  std::vector<Configuration> configurations; // empty: restart() was not called
  uint32_t current = no_configuration;       // of the last frame
  uint32_t before = no_configuration;        // ran before `current`
  bool tried = false;                        // the error of `current` was unproven when it entered
  bool provisional = true;                   // the last decision
  double units = 0;                          // of samples in the last frame
  double clock_s = 0;                        // sum of the seconds of all frames
  double started_s = 0, entered_s = 0;       // clock at restart(), and at the last switch
  // expected time of `current` over the calibrated one at the last switch; infinite for a trial
  double entered_factor = 0;
  double tokens = 0;     // switches that may follow at once (token bucket)
  uint32_t switches = 0; // since the state was created
};

// Forgets everything except the clock and the number of switches. `unmeasured`: number of passes
// whose time is not known, all of which may be tried in the first seconds. Allocates only if no
// earlier state was as large.
void restart(DecisionState& state, size_t configurations, size_t unmeasured);
// Makes the next decision free of earlier switches: the state is as after a long calm time.
void allow_switches(DecisionState& state);
// Advances the clock in a frame without a budget. The next decision is a first one, and begins the
// first seconds.
void skip_frame(DecisionState& state, double seconds);

// Returns whether a configuration that ran before may be tried again, as far as its back-off says.
bool may_return(const DecisionState& state, uint32_t configuration);

// Values of one configuration that decide() needs in between.
struct Assessment {
  double entering_ms = 0, running_ms = 0;         // decide about entering and staying
  double fill_ms = 0, leave_ms = 0, enter_ms = 0; // limits: the budget less margins
  double units = 0, entering_units = 0;
  double rmse = 0, entering_rmse = 0;
  bool trial = false; // fits only if its optimistic time is right
};

// Decides for a frame: one forecast per configuration, at least one. Equal forecasts and states
// give equal decisions. `scratch` has as many elements as `forecasts`. Allocates nothing.
Decision decide(std::span<const Forecast> forecasts, const FrameInput& frame, DecisionState& state,
                std::span<Assessment> scratch);

} // namespace dermis::choice
