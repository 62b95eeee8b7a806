#pragma once
// Which of a graph's outcomes runs in the next frame: the least expected error whose predicted time fits the
// budget, without switching to and fro.

#include <cstdint>
#include <span>

namespace dermis::choice {

// What one outcome (a value for each setting "by": "budget") is expected to do in the next frame.
struct Forecast {
  double ms = 0, spread_ms = 0; // device time, and its typical deviation
  double rmse = 0;              // expected error
  double missed_rmse = 0;       // part of it: light through thin parts that it does not see
};

enum class ReasonKind : uint8_t {
  no_budget,    // the host gave none: the defaults
  first_frame,  // nothing ran before
  fits_best,    // the least error that fits, and it ran before
  better_fits,  // less error than what ran before, and it fits
  over_budget,  // what ran before does not fit any more
  nothing_fits, // every outcome is over budget: the fastest
  held,         // another is better, but not by enough, or the last switch is too near
};

// Room that an outcome needs in a budget before it is switched to. What fills a budget with samples leaves as
// much, so that it is neither kept out nor pushed out by its own samples.
inline constexpr double entry_margin = 1.05;

struct Decision {
  uint32_t outcome = 0;
  ReasonKind why = ReasonKind::first_frame;
  uint32_t next_better =
      UINT32_MAX;        // the fastest outcome with less error that does not fit; none: UINT32_MAX
  double missing_ms = 0; // what the budget lacks for it
  bool transmission_stats =
      false; // but for light through them another outcome that fits would have less error
};

const char* why_text(const Decision& decision); // static, for people

// What a decision remembers of earlier ones. Plain data: a copy is another history.
struct DecisionState {
  uint32_t outcome = UINT32_MAX; // of the last frame; none yet: UINT32_MAX
  double seconds_since_switch = 0;
  uint32_t switches = 0;
};

// budget_ms > 0; `seconds` after the last frame, 0: a sixtieth. The same forecasts and state give the same
// decision. Allocates nothing.
Decision decide(std::span<const Forecast> forecasts, double budget_ms, double seconds, DecisionState& state);

} // namespace dermis::choice
