#pragma once
// The controller decides which of a graph's configurations runs in the next frame: the least
// expected error whose predicted time fits the budget, with hysteresis.

#include <cstdint>
#include <span>

namespace dermis::choice {

// Expected result of one configuration (a value for each setting "by": "budget") in the next frame.
struct Forecast {
  double ms = 0, spread_ms = 0; // device time and its typical deviation
  double rmse = 0;              // expected error
  // part of rmse: light transmitted through thin parts that the configuration ignores
  double missed_rmse = 0;
};

enum class ReasonKind : uint8_t {
  no_budget,    // the host gave no budget: the defaults
  first_frame,  // no configuration ran before
  fits_best,    // the least error that fits; the configuration ran before
  better_fits,  // less error than the previous configuration, and fits
  over_budget,  // the previous configuration does not fit any more
  nothing_fits, // every configuration is over budget: the fastest
  held, // another configuration is better, but by too little, or the last switch is too recent
};

// Factor on the bound of an configuration that must fit the budget before a switch to the
// configuration. Configurations that fill a budget with samples leave the same margin, so that
// their own samples neither prevent a switch to them nor force a switch away.
inline constexpr double entry_margin = 1.05;

struct Decision {
  uint32_t configuration = 0;
  ReasonKind why = ReasonKind::first_frame;
  // The fastest configuration with less error that does not fit; UINT32_MAX: none.
  uint32_t next_better = UINT32_MAX;
  double missing_ms = 0; // milliseconds by which next_better exceeds the budget
  // Whether another configuration that fits would have less error without transmitted light.
  bool transmission_stats = false;
};

const char* why_text(const Decision& decision); // Returns a static text for people.

// State that a decision keeps of earlier decisions. Plain data: a copy is an independent history.
struct DecisionState {
  uint32_t configuration = UINT32_MAX; // configuration of the last frame; UINT32_MAX: none yet
  double seconds_since_switch = 0;
  uint32_t switches = 0;
};

// Decides for a frame. budget_ms > 0; `seconds` since the last frame, 0: 1/60 s. Equal forecasts
// and state give equal decisions. Allocates nothing.
Decision decide(std::span<const Forecast> forecasts, double budget_ms, double seconds,
                DecisionState& state);

} // namespace dermis::choice
