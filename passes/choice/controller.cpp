#include "passes/choice/controller.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr double margin = 1.0; // typical deviations that must fit in addition to the prediction
// factor on the budget within which the running configuration stays
constexpr double stay_tolerance = 1.03;
// a switch needs an error below this fraction of the running configuration's
constexpr double worth_a_switch = 0.97;
// seconds between switches that no budget forces; with the switches back, 2 per second
constexpr double cool_down = 1;
constexpr double usual_frame = 1.0 / 60; // seconds, if the host gives no time

double bound_ms(const Forecast& forecast) {
  return forecast.ms + margin * forecast.spread_ms;
}

bool less_error(const Forecast& a, const Forecast& b) {
  return a.rmse != b.rmse ? a.rmse < b.rmse : a.ms < b.ms;
}

// Returns the configuration with the smallest time; the first of equal ones.
uint32_t fastest(std::span<const Forecast> forecasts) {
  uint32_t best = 0;
  for (uint32_t i = 1; i < forecasts.size(); ++i)
    if (forecasts[i].ms < forecasts[best].ms) best = i;
  return best;
}

// Returns the configuration with the least error among those for which `factor` times the bound
// fits the budget. UINT32_MAX: none.
uint32_t best_within(std::span<const Forecast> forecasts, double budget_ms, double factor) {
  uint32_t best = UINT32_MAX;
  for (uint32_t i = 0; i < forecasts.size(); ++i)
    if (factor * bound_ms(forecasts[i]) <= budget_ms &&
        (best == UINT32_MAX || less_error(forecasts[i], forecasts[best])))
      best = i;
  return best;
}

void find_next_better(std::span<const Forecast> forecasts, double budget_ms, Decision& decision) {
  for (uint32_t i = 0; i < forecasts.size(); ++i) {
    const double unmet = bound_ms(forecasts[i]) - budget_ms;
    if (forecasts[i].rmse >= forecasts[decision.configuration].rmse || unmet <= 0) continue;
    if (decision.next_better != UINT32_MAX && unmet >= decision.missing_ms) continue;
    decision.next_better = i;
    decision.missing_ms = unmet;
  }
}

double seen_square(const Forecast& forecast) {
  return forecast.rmse * forecast.rmse - forecast.missed_rmse * forecast.missed_rmse;
}

bool decided_by_transmission(std::span<const Forecast> forecasts, double budget_ms,
                             uint32_t configuration) {
  const Forecast& now = forecasts[configuration];
  return std::any_of(forecasts.begin(), forecasts.end(), [&](const Forecast& other) {
    return bound_ms(other) <= budget_ms && seen_square(other) < seen_square(now) &&
           other.rmse > now.rmse;
  });
}

Decision choose(std::span<const Forecast> forecasts, double budget_ms, const DecisionState& state) {
  const uint32_t best = best_within(forecasts, budget_ms, 1.0);
  if (best == UINT32_MAX) return {fastest(forecasts), ReasonKind::nothing_fits};
  if (state.configuration >= forecasts.size()) return {best, ReasonKind::first_frame};
  const uint32_t now = state.configuration;
  if (bound_ms(forecasts[now]) > stay_tolerance * budget_ms) return {best, ReasonKind::over_budget};
  const uint32_t better = best_within(forecasts, budget_ms, entry_margin);
  if (better == UINT32_MAX || better == now || !less_error(forecasts[better], forecasts[now]))
    return {now, best == now ? ReasonKind::fits_best : ReasonKind::held};
  const bool worth = forecasts[better].rmse <= worth_a_switch * forecasts[now].rmse;
  if (!worth || state.seconds_since_switch < cool_down) return {now, ReasonKind::held};
  return {better, ReasonKind::better_fits};
}

const char* text_of(ReasonKind why) {
  switch (why) {
  case ReasonKind::no_budget:
    return "no budget is set";
  case ReasonKind::first_frame:
    return "least error within the budget; first frame";
  case ReasonKind::fits_best:
    return "least error within the budget";
  case ReasonKind::better_fits:
    return "a configuration with less error now fits the budget";
  case ReasonKind::over_budget:
    return "the previous configuration exceeds the budget";
  case ReasonKind::nothing_fits:
    return "no configuration fits the budget: the fastest runs";
  case ReasonKind::held:
    return "kept, to switch less often";
  }
  return "";
}

} // namespace

const char* why_text(const Decision& decision) {
  if (!decision.transmission_stats) return text_of(decision.why);
  switch (decision.why) {
  case ReasonKind::first_frame:
    return "least error within the budget, considering transmitted light; first frame";
  case ReasonKind::fits_best:
    return "least error within the budget, considering transmitted light";
  case ReasonKind::better_fits:
    return "a configuration with less error now fits the budget, considering transmitted light";
  case ReasonKind::no_budget:
  case ReasonKind::over_budget:
  case ReasonKind::nothing_fits:
  case ReasonKind::held:
    break;
  }
  return text_of(decision.why);
}

Decision decide(std::span<const Forecast> forecasts, double budget_ms, double seconds,
                DecisionState& state) {
  Decision decision = choose(forecasts, budget_ms, state);
  find_next_better(forecasts, budget_ms, decision);
  decision.transmission_stats =
      decided_by_transmission(forecasts, budget_ms, decision.configuration);
  const bool first = state.configuration == UINT32_MAX;
  const bool switched = !first && decision.configuration != state.configuration;
  const double passed = seconds > 0 ? seconds : usual_frame;
  state.seconds_since_switch = switched || first ? 0 : state.seconds_since_switch + passed;
  state.switches += switched ? 1 : 0;
  state.configuration = decision.configuration;
  return decision;
}

} // namespace dermis::choice
