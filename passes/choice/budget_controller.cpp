#include "passes/choice/budget_controller.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

// Logarithms of factors. Beyond this fraction of the margin, what runs is left: errors of estimates
// must not do so.
constexpr double leave_margin = 0.7;
// A configuration that enters leaves a gap in addition to the margin: a minimum, and a fraction of
// the margin.
constexpr double min_gap = 0.02, gap_of_margin = 0.3;
// A switch needs an error below this fraction of the running configuration's. Trials rank behind
// known configurations by the same factor.
constexpr double worth_a_switch = 0.98;
// A configuration whose error is known from fewer than proven_frames is unproven, if the error of
// what runs is measured. It is entered only for an error below this fraction. The same gain is
// needed to leave what runs because of its first few probed frames.
constexpr double worth_a_try = 0.9, few_frames = 4;
// An unproven error below this fraction is entered as what fits for certain.
constexpr double far_better = 0.5;
constexpr double min_frames = 0.5; // fewer measure nothing, because they are old
// Token bucket: at most T + 1 switches in any T >= 1 seconds.
constexpr double switches_per_second = 0.5, max_tokens = 2;
// A trial needs another switch to come back. So may what should fit for certain, if times were
// disturbed when it was judged: then it is left after at most a second. So may an unproven one,
// from which the configuration before returns at once, or after at most a second if its error was
// expected to be far smaller.
constexpr double trial_tokens = 2, better_tokens = 1.5, leaving_tokens = 1;
// Until the first seconds have passed, each pass may be tried.
constexpr double first_s = 3, first_tokens_per_pass = 2;
// A frame counts as at most this time of the first seconds: after a pause, nothing was tried yet.
constexpr double longest_first_frame_s = 0.1;
constexpr double trial_s = 1; // left sooner, a trial failed
// A configuration that was left is not tried again for its back-off, which doubles each time up to
// a maximum, and restarts after the configuration ran for this many back-offs.
constexpr double first_backoff_s = 1, max_backoff_s = 64, calm_backoffs = 10;
// Without trials, disturbances count as over after this many back-offs.
constexpr double forgotten_backoffs = 10;
// A configuration that was not tried in the first seconds is not tried for this time.
constexpr double untried_backoff_s = 300;
// A configuration that is left within this time because it takes longer than expected was
// misjudged. The first time, a disturbance may be the reason; then an equal expectation is wrong
// again.
constexpr double misjudged_s = 2;
constexpr uint32_t often_misjudged = 2;
// During its back-off, a configuration is tried only if it became cheaper by this logarithm.
constexpr double changed = 0.10;
// Times within this factor count as equal where nothing fits.
constexpr double equally_fast = 1.03;
constexpr double never_ms = 1e30;
constexpr double usual_frame_s = 1.0 / 60; // if the host gives no time
constexpr double min_ms = 1e-12;
// Samples increase only by more than this factor and number, or if all fit.
constexpr double units_factor = 1.05, units_step = 1;

double seconds_of(double seconds) {
  return seconds > 0 ? seconds : usual_frame_s;
}

double seen_square(const Forecast& forecast, double rmse) {
  return rmse * rmse - forecast.missed_rmse * forecast.missed_rmse;
}

double calibrated_of(const TimeForecast& time) {
  return time.calibrated_ms > 0 ? time.calibrated_ms : 1;
}

class Controller {
public:
  Controller(std::span<const Forecast> forecasts, const FrameInput& frame, DecisionState& state,
             std::span<Assessment> scratch)
      : forecasts_(forecasts), frame_(frame), state_(state), assessed_(scratch) {}

  Decision decide() {
    const bool first_seconds_end = advance();
    for (uint32_t i = 0; i < forecasts_.size(); ++i)
      assess(i);
    Decision decision;
    choose(decision);
    if (first_seconds_end && frame_.trials == Trials::on) set_aside_untried();
    enter(decision);
    find_next_better(decision);
    decision.by_transmission = decided_by_transmission(decision);
    return decision;
  }

private:
  // Returns whether the first seconds end in this frame.
  bool advance() {
    const double seconds = seconds_of(frame_.seconds);
    const double before = state_.clock_s - state_.started_s;
    state_.clock_s += seconds;
    // Without anything that scatters, nothing can be tried.
    const bool waits = frame_.empty || frame_.idle;
    if (before <= first_s)
      state_.started_s += waits ? seconds : std::max(0.0, seconds - longest_first_frame_s);
    const double after = state_.clock_s - state_.started_s;
    const double refilled = std::min(max_tokens, state_.tokens + switches_per_second * seconds);
    state_.tokens = after > first_s ? refilled : std::max(refilled, state_.tokens);
    return before <= first_s && after > first_s;
  }

  bool may_try() const {
    return frame_.trials == Trials::on || (frame_.trials == Trials::cuts_only && frame_.cut);
  }

  void assess(uint32_t i) {
    const Forecast& forecast = forecasts_[i];
    const TimeForecast& time = forecast.time;
    const DecisionState::Configuration& kept = state_.configurations[i];
    Assessment& out = assessed_[i];
    const bool rested = state_.clock_s - kept.left_s > kept.backoff_s;
    out.fill_ms = frame_.budget_ms * std::exp(-forecast.margin);
    out.leave_ms = frame_.budget_ms * std::exp(-leave_margin * forecast.margin);
    out.enter_ms = out.fill_ms * std::exp(-min_gap - gap_of_margin * forecast.margin);
    out.trial = time.pessimistic_ms > out.enter_ms;
    // Without trials, a configuration returns after a longer time.
    const bool may_return =
        state_.clock_s - kept.left_s > (may_try() ? 1 : forgotten_backoffs) * kept.backoff_s;
    const bool barred =
        !may_return && time.expected_ms > kept.left_ratio * frame_.budget_ms * std::exp(-changed);
    out.running_ms = rested ? time.undisturbed_ms : time.optimistic_ms;
    const double disturbance_ms = time.optimistic_ms - time.undisturbed_ms;
    const double entering_ms =
        may_try() ? out.running_ms : time.expected_ms - (may_return ? disturbance_ms : 0);
    out.entering_ms = barred ? never_ms : entering_ms;
    out.units = out.entering_units = 0;
    if (forecast.takes_samples && forecast.demand > 0) {
      const double entering_unit_ms = rested && may_try() ? time.undisturbed_unit_ms : time.unit_ms;
      out.units = units_within(out.fill_ms - time.pessimistic_ms, time.unit_ms, forecast.demand);
      out.entering_units =
          units_within(out.enter_ms - entering_ms, entering_unit_ms, forecast.demand);
    }
    out.rmse = rmse_with(forecast, out.units);
    out.entering_rmse = rmse_with(forecast, out.entering_units);
  }

  static double units_within(double ms, double unit_ms, double demand) {
    return std::clamp(ms / std::max(unit_ms, min_ms), 0.0, demand);
  }

  // Returns the number of probed frames of what runs; 0: its error is not measured.
  double frames_of_current() const {
    if (state_.current == no_configuration) return 0;
    const double frames = forecasts_[state_.current].error_frames;
    return frames > min_frames ? frames : 0;
  }
  // In the frame of a cut, a change is not visible.
  bool unproven(uint32_t i) const {
    return i != state_.current && !frame_.cut && frames_of_current() > 0 &&
           forecasts_[i].is_probed && forecasts_[i].error_frames < proven_frames;
  }
  bool may_enter_unproven(uint32_t i) const {
    const bool first_trial = assessed_[i].trial && state_.clock_s - state_.started_s <= first_s;
    return state_.tokens >= (is_far_better(i) ? better_tokens : trial_tokens) &&
           (!frame_.learning || first_trial);
  }
  bool is_far_better(uint32_t i) const {
    return unproven(i) && !assessed_[i].trial &&
           assessed_[i].entering_rmse < far_better * assessed_[state_.current].rmse;
  }
  // Returns whether the running configuration was entered unproven, or its error is being learned.
  bool is_tried() const {
    const double frames = frames_of_current();
    return frames > 0 && (state_.tried || frames < proven_frames || frame_.learning);
  }

  template <class Fits> uint32_t best(Fits fits) const {
    uint32_t found = no_configuration;
    double least = 0;
    for (uint32_t i = 0; i < assessed_.size(); ++i) {
      const double gain = unproven(i) ? worth_a_try : assessed_[i].trial ? worth_a_switch : 1;
      const double rmse = assessed_[i].entering_rmse / gain;
      if (!fits(i) || (found != no_configuration && rmse >= least)) continue;
      found = i;
      least = rmse;
    }
    return found;
  }

  // Chooses the least error that fits for certain; the fastest if nothing fits.
  void choose_known(double Assessment::*limit, Decision& decision, ReasonKind why) const {
    decision.why = why;
    decision.configuration =
        best([&](uint32_t i) { return forecasts_[i].time.pessimistic_ms <= assessed_[i].*limit; });
    if (decision.configuration != no_configuration) return;
    decision.why = ReasonKind::nothing_fits;
    decision.configuration = fastest();
  }

  // Returns the fastest configuration; what runs, if it is as fast within the noise of times.
  uint32_t fastest() const {
    const auto faster = [](const Forecast& a, const Forecast& b) {
      return a.time.pessimistic_ms < b.time.pessimistic_ms;
    };
    const auto least = std::min_element(forecasts_.begin(), forecasts_.end(), faster);
    const uint32_t now = state_.current;
    return now != no_configuration &&
                   forecasts_[now].time.pessimistic_ms <= equally_fast * least->time.pessimistic_ms
               ? now
               : static_cast<uint32_t>(least - forecasts_.begin());
  }

  // Leaves the running configuration, which exceeds the budget.
  void choose_other(Decision& decision) const {
    const bool tried = state_.clock_s - state_.entered_s < trial_s;
    choose_known(tried ? &Assessment::fill_ms : &Assessment::enter_ms, decision,
                 tried ? ReasonKind::trial_failed : ReasonKind::over_budget);
    if (tried) return_from_trial(decision);
    if (tried || state_.tokens < trial_tokens || !may_try()) return;
    if (decision.why == ReasonKind::nothing_fits) {
      const uint32_t might_fit =
          best([&](uint32_t i) { return assessed_[i].entering_ms <= assessed_[i].enter_ms; });
      if (might_fit == no_configuration || might_fit == state_.current) return;
      decision.configuration = might_fit;
      decision.why = ReasonKind::trial;
      return;
    }
    // Once the first trials are over, one that never ran may serve if it should fit.
    const bool first_trials = state_.clock_s - state_.started_s <= first_s;
    if (first_trials || frame_.trials != Trials::on) return;
    const uint32_t expected = best([&](uint32_t i) {
      return assessed_[i].entering_ms < never_ms &&
             forecasts_[i].time.expected_ms <= assessed_[i].enter_ms;
    });
    if (expected != no_configuration &&
        assessed_[expected].entering_rmse <
            worth_a_switch * assessed_[decision.configuration].entering_rmse)
      decision.configuration = expected;
  }

  // A configuration that ran well before a trial may return, even if it would not be entered now.
  void return_from_trial(Decision& decision) const {
    const uint32_t before = state_.before;
    if (before == no_configuration || before == state_.current ||
        forecasts_[before].time.pessimistic_ms > assessed_[before].leave_ms)
      return;
    if (decision.why != ReasonKind::nothing_fits &&
        assessed_[before].rmse >= assessed_[decision.configuration].entering_rmse)
      return;
    decision.configuration = before;
    decision.why = ReasonKind::trial_failed;
  }

  void choose(Decision& decision) const {
    const uint32_t now = state_.current;
    if (now == no_configuration || state_.provisional)
      return choose_known(&Assessment::enter_ms, decision, ReasonKind::first_frame);
    decision.configuration = now;
    if (frame_.empty) {
      decision.why = ReasonKind::held;
      return;
    }
    if (assessed_[now].running_ms > assessed_[now].leave_ms) {
      choose_other(decision);
      if (decision.configuration == now || state_.tokens >= leaving_tokens) return;
      decision.configuration = now;
      decision.why = ReasonKind::held;
      return;
    }
    const auto fits = [&](uint32_t i) { return assessed_[i].entering_ms <= assessed_[i].enter_ms; };
    if (frame_.idle) { // no configuration would have an error
      decision.why = ReasonKind::held;
      return;
    }
    uint32_t better = best(fits);
    const bool barred =
        better != no_configuration && unproven(better) && !may_enter_unproven(better);
    if (barred)
      better = best([&](uint32_t i) { return fits(i) && (!unproven(i) || may_enter_unproven(i)); });
    decision.why = barred ? ReasonKind::held : ReasonKind::fits_best;
    if (returns_before(better)) {
      decision.configuration = state_.before;
      decision.why = ReasonKind::better_fits;
      return;
    }
    if (better == no_configuration || better == now ||
        assessed_[better].entering_rmse >= assessed_[now].rmse)
      return;
    decision.why = ReasonKind::held;
    if (!is_worth_a_switch(better)) return;
    decision.configuration = better;
    decision.why =
        assessed_[better].trial && may_try() ? ReasonKind::trial : ReasonKind::better_fits;
  }

  // Returns whether the configuration that ran before the one that is being tried returns. It may
  // run even if it would not be entered now. `better`: the least error that fits. If that has to
  // wait for tokens, what ran before need not be as good.
  bool returns_before(uint32_t better) const {
    const uint32_t i = state_.before, now = state_.current;
    if (i == no_configuration || !is_tried() || unproven(i) || state_.tokens < leaving_tokens ||
        assessed_[i].entering_ms == never_ms ||
        forecasts_[i].time.pessimistic_ms > assessed_[i].leave_ms ||
        assessed_[i].rmse > gain_to_leave() * assessed_[now].rmse)
      return false;
    if (better == no_configuration || better == now) return true;
    return (is_worth_a_switch(better) ? 1 : worth_a_try) * assessed_[i].rmse <=
           assessed_[better].entering_rmse;
  }

  double gain_to_leave() const {
    const bool few = frames_of_current() > 0 && frames_of_current() < few_frames;
    return few ? worth_a_try : worth_a_switch;
  }

  bool is_often_misjudged(uint32_t i) const {
    return state_.configurations[i].misjudged >= often_misjudged;
  }

  bool is_worth_a_switch(uint32_t i) const {
    const bool may_fail = assessed_[i].trial || is_often_misjudged(i);
    return state_.tokens >= (may_fail ? trial_tokens : better_tokens) &&
           assessed_[i].entering_rmse <=
               (unproven(i) ? worth_a_try : gain_to_leave()) * assessed_[state_.current].rmse;
  }

  // Configurations that do not fit at best are not tried because of noise. Where times are certain,
  // nothing has to be tried.
  void set_aside_untried() {
    for (uint32_t i = 0; i < assessed_.size(); ++i) {
      DecisionState::Configuration& kept = state_.configurations[i];
      const TimeForecast& time = forecasts_[i].time;
      if (kept.ran || assessed_[i].entering_ms <= assessed_[i].enter_ms ||
          time.optimistic_ms >= time.expected_ms)
        continue;
      kept.left_ratio = time.expected_ms / frame_.budget_ms;
      kept.left_s = state_.clock_s;
      kept.backoff_s = untried_backoff_s;
    }
  }

  void enter(Decision& decision) {
    const uint32_t before = state_.current, now = decision.configuration;
    const bool switched = before != no_configuration && now != before;
    if (switched && !state_.provisional) leave(before, decision);
    if (switched && !state_.provisional) ++state_.switches;
    if (switched || before == no_configuration) {
      state_.entered_s = state_.clock_s;
      const TimeForecast& time = forecasts_[now].time;
      state_.entered_factor =
          assessed_[now].trial ? HUGE_VAL : time.expected_ms / calibrated_of(time);
    }
    if (switched) {
      state_.before = before;
      state_.tried = unproven(now);
    }
    state_.current = now;
    state_.provisional = frame_.provisional;
    DecisionState::Configuration& kept = state_.configurations[now];
    if (!kept.ran) kept.backoff_s = first_backoff_s; // it was only set aside
    kept.ran = true;
    if (state_.clock_s - state_.entered_s > calm_backoffs * kept.backoff_s)
      kept.backoff_s = first_backoff_s;
    if (state_.clock_s - state_.entered_s > misjudged_s) kept.misjudged = 0;
    take_units(switched, decision);
  }

  void leave(uint32_t before, Decision& decision) {
    state_.tokens -= 1;
    const bool over = assessed_[before].running_ms > assessed_[before].leave_ms;
    if (!over) return;
    DecisionState::Configuration& kept = state_.configurations[before];
    const TimeForecast& time = forecasts_[before].time;
    const double expected_ms = state_.entered_factor * calibrated_of(time); // for this content
    double ms = time.pessimistic_ms;
    if (state_.clock_s - state_.entered_s < misjudged_s && expected_ms < ms * std::exp(-changed)) {
      ++kept.misjudged;
      if (is_often_misjudged(before)) ms = expected_ms;
    }
    kept.left_ratio = ms / frame_.budget_ms;
    kept.left_s = state_.clock_s;
    kept.backoff_s = std::min(2 * kept.backoff_s, max_backoff_s);
    decision.rejected = before;
  }

  void take_units(bool switched, Decision& decision) {
    const Forecast& forecast = forecasts_[decision.configuration];
    const TimeForecast& time = forecast.time;
    const double fits = assessed_[decision.configuration].units;
    const bool more = fits > units_factor * state_.units + units_step || fits >= forecast.demand;
    if (switched || fits < state_.units || more) state_.units = fits;
    decision.units = forecast.takes_samples ? state_.units : 0;
    const double affordable = (assessed_[decision.configuration].fill_ms - time.pessimistic_ms) /
                              std::max(time.unit_ms, min_ms);
    decision.max_units =
        state_.units >= forecast.demand ? std::max(affordable, 0.0) : decision.units;
    decision.expected_ms = time.pessimistic_ms + decision.units * time.unit_ms;
    decision.bound_ms = decision.expected_ms * std::exp(forecast.margin);
    decision.rmse = rmse_with(forecast, decision.units);
    decision.measured = time.measured;
  }

  // Returns the budget that the configuration needs to be entered for certain.
  double needed_ms(uint32_t i) const {
    return forecasts_[i].time.pessimistic_ms * frame_.budget_ms / assessed_[i].enter_ms;
  }

  void find_next_better(Decision& decision) const {
    for (uint32_t i = 0; i < forecasts_.size(); ++i) {
      const double missing = needed_ms(i) - frame_.budget_ms;
      if (assessed_[i].entering_rmse >= decision.rmse || missing <= 0) continue;
      if (decision.next_better != no_configuration && missing >= decision.missing_ms) continue;
      decision.next_better = i;
      decision.missing_ms = missing;
    }
  }

  bool decided_by_transmission(const Decision& decision) const {
    const Forecast& now = forecasts_[decision.configuration];
    for (uint32_t i = 0; i < forecasts_.size(); ++i) {
      const double other = assessed_[i].entering_rmse;
      if (needed_ms(i) <= frame_.budget_ms && other > decision.rmse &&
          seen_square(forecasts_[i], other) < seen_square(now, decision.rmse))
        return true;
    }
    return false;
  }

  std::span<const Forecast> forecasts_;
  const FrameInput& frame_;
  DecisionState& state_;
  std::span<Assessment> assessed_;
};

} // namespace

double rmse_with(const Forecast& forecast, double units) {
  if (!forecast.takes_samples) return forecast.rmse;
  const double fraction = forecast.demand > 0 ? std::min(1.0, units / forecast.demand) : 0;
  const double all = forecast.rmse * forecast.rmse;
  const double none = forecast.unsampled_rmse * forecast.unsampled_rmse;
  return std::sqrt(all + std::pow(1 - fraction, forecast.concentration) * (none - all));
}

double needed_budget_ms(const Forecast& forecast, double units) {
  return (forecast.time.pessimistic_ms + units * forecast.time.unit_ms) *
         std::exp((1 + gap_of_margin) * forecast.margin + min_gap);
}

void restart(DecisionState& state, size_t configurations, size_t unmeasured) {
  state.configurations.assign(configurations, {});
  state.current = state.before = no_configuration;
  state.provisional = true;
  state.tried = false;
  state.units = 0;
  state.started_s = state.entered_s = state.clock_s;
  state.tokens = std::max(max_tokens, first_tokens_per_pass * double(unmeasured));
}

void allow_switches(DecisionState& state) {
  state.tokens = max_tokens;
  state.entered_s = state.started_s = state.clock_s - 2 * first_s;
  state.units = 0;
}

bool may_return(const DecisionState& state, uint32_t configuration) {
  if (configuration >= state.configurations.size() || configuration == state.current) return false;
  const DecisionState::Configuration& kept = state.configurations[configuration];
  return kept.ran && state.clock_s - kept.left_s > kept.backoff_s;
}

void skip_frame(DecisionState& state, double seconds) {
  state.clock_s += seconds_of(seconds);
  state.started_s = state.clock_s;
  state.tokens = std::max(max_tokens, state.tokens);
  state.current = state.before = no_configuration;
}

Decision decide(std::span<const Forecast> forecasts, const FrameInput& frame, DecisionState& state,
                std::span<Assessment> scratch) {
  return Controller(forecasts, frame, state, scratch).decide();
}

} // namespace dermis::choice
