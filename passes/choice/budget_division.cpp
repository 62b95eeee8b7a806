#include "passes/choice/budget_division.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dermis::choice {
namespace {

constexpr size_t steps = 256;         // of the budget, in which offers are rounded up
constexpr double period_s = 1;        // between divisions
constexpr uint64_t absent_rounds = 8; // a view that misses as many gives its share to the others
// A view that is recorded regularly, but rarely, is absent after this many of its intervals. Views
// that are rarer than once in longest_interval rounds come and go.
constexpr uint64_t absent_intervals = 2, longest_interval = 60;
// A division replaces the previous one if it has at most this fraction of the squared error.
constexpr double worth_a_change = 0.96;

constexpr double least_ms = 1e-6; // also where work costs nothing: a budget is above 0

double square(double value) {
  return value * value;
}

void insert(Offers& offers, const Offer& one) {
  const auto begin = offers.all.begin(), end = begin + static_cast<ptrdiff_t>(offers.count);
  const auto dominates = [&](const Offer& other) {
    return other.ms <= one.ms && other.rmse <= one.rmse;
  };
  if (std::any_of(begin, end, dominates)) return;
  const auto kept = std::remove_if(
      begin, end, [&](const Offer& other) { return one.ms <= other.ms && one.rmse <= other.rmse; });
  offers.count = static_cast<size_t>(kept - begin);
  if (offers.count == offers.all.size()) return;
  const auto at = std::find_if(begin, kept, [&](const Offer& other) { return other.ms > one.ms; });
  std::move_backward(at, kept, kept + 1);
  *at = one;
  ++offers.count;
}

bool has_part(const ViewShare& view) {
  return view.counted && view.fraction > 0;
}

bool is_no_work(const Offers& offers) {
  return offers.count > 0 && offers.all[0].ms <= least_ms;
}

// Returns the squared error with a share of `ms`; the cheapest offer runs in any case.
double square_within(const Offers& offers, double ms) {
  double rmse = offers.all[0].rmse;
  for (const Offer& one : offers.list())
    if (one.ms <= ms) rmse = one.rmse;
  return square(rmse);
}

// Pessimism would keep a configuration that never ran from a trial, and a disturbance that may be
// over one that was left because of it.
Forecast as_offered(std::span<const Forecast> forecasts, const DecisionState& state, uint32_t i) {
  Forecast one = forecasts[i];
  one.time.pessimistic_ms = may_return(state, i) ? one.time.usual_ms : one.time.expected_ms;
  return one;
}

size_t steps_of(const Offer& offer, double budget_ms) {
  return static_cast<size_t>(
      std::min(std::ceil(offer.ms / budget_ms * double(steps)), double(steps + 1)));
}

} // namespace

Offers make_offers(std::span<const Forecast> forecasts, const DecisionState& state) {
  // Fractions of the requested samples. There is a place for each configuration without samples.
  constexpr double sampled[] = {0, 0.25, 0.5, 0.75, 1};
  Offers offers;
  for (const double fraction : sampled)
    for (uint32_t i = 0; i < forecasts.size(); ++i) {
      if (fraction > 0 && !forecasts[i].takes_samples) continue;
      const Forecast one = as_offered(forecasts, state, i);
      const double units = one.takes_samples ? fraction * one.demand : 0;
      insert(offers, {std::max(needed_budget_ms(one, units), least_ms), rmse_with(one, units)});
    }
  return offers;
}

Offers offers_of_idle(std::span<const Forecast> forecasts, const DecisionState& state) {
  double ms = HUGE_VAL;
  for (uint32_t i = 0; i < forecasts.size(); ++i)
    if (state.current == no_configuration || i == state.current)
      ms = std::min(ms, needed_budget_ms(as_offered(forecasts, state, i), 0));
  Offers offers;
  insert(offers, {std::max(ms, 2 * least_ms), 0});
  return offers;
}

Offers offers_of_no_work() {
  Offers offers;
  insert(offers, {least_ms, 0});
  return offers;
}

size_t division_table_size(size_t views) {
  return views * (steps + 1);
}

// A knapsack with one choice per view. Row v of the table holds the least squared error of views 0
// to v within a number of steps; infinite if their cheapest offers do not fit.
double divide(double budget_ms, std::span<ViewShare* const> views, std::span<double> table,
              std::span<double> fractions) {
  const auto row = [&](size_t v) { return table.subspan(v * (steps + 1), steps + 1); };
  for (size_t v = 0; v < views.size(); ++v) {
    std::ranges::fill(row(v), HUGE_VAL);
    for (const Offer& offer : views[v]->offers.list()) {
      const size_t needed = steps_of(offer, budget_ms);
      for (size_t s = needed; s <= steps; ++s) {
        const double before = v == 0 ? 0 : row(v - 1)[s - needed];
        row(v)[s] = std::min(row(v)[s], before + square(offer.rmse));
      }
    }
  }
  const double least = row(views.size() - 1)[steps];
  double sum = 0;
  size_t left = steps;
  for (size_t v = views.size(); v-- > 0;) {
    const Offers& offers = views[v]->offers;
    fractions[v] = offers.all[0].ms;
    for (const Offer& offer : offers.list()) {
      if (least == HUGE_VAL) break;
      const size_t needed = steps_of(offer, budget_ms);
      if (needed > left) break;
      const double before = v == 0 ? 0 : row(v - 1)[left - needed];
      if (before + square(offer.rmse) > row(v)[left]) continue;
      fractions[v] = offer.ms;
      left -= needed;
      break;
    }
    sum += fractions[v];
  }
  for (double& fraction : fractions.first(views.size()))
    fraction = sum > 0 ? fraction / sum : 1 / double(views.size());
  if (least < HUGE_VAL) return least;
  double without = 0;
  for (const ViewShare* view : views)
    without += square(view->offers.all[0].rmse);
  return without;
}

void BudgetDivision::add(ViewShare& view) {
  const size_t views = views_.size() + 1;
  active_.reserve(views);
  table_.resize(division_table_size(views));
  fractions_.resize(views);
  views_.push_back(&view);
  view.round = round_; // the others give up its part before its first frame
}

void BudgetDivision::remove(const ViewShare& view) noexcept {
  std::erase(views_, &view);
  changed_ = changed_ || view.active;
}

void BudgetDivision::list_active() noexcept {
  active_.clear();
  for (ViewShare* view : views_) {
    const bool active =
        round_ - view->round <= std::max(absent_rounds, absent_intervals * view->interval);
    changed_ = changed_ || view->active != active;
    view->active = active;
    if (active) active_.push_back(view);
  }
}

// `at_once`: the old division does not serve any more.
void BudgetDivision::divide_anew(bool at_once) noexcept {
  const bool counted = std::all_of(active_.begin(), active_.end(),
                                   [](const ViewShare* view) { return view->counted; });
  if (!counted) {
    if (at_once) make_room();
    divided_ = false;
    return;
  }
  if (!at_once && divided_ && elapsed_s_ < period_s) return;
  elapsed_s_ = 0;
  divided_ = true;
  at_once = at_once || std::ranges::any_of(active_, [&](const ViewShare* view) {
              return view->fraction * budget_ms_ < view->offers.all[0].ms; // it grew
            });
  const double squares = divide(budget_ms_, active_, table_, fractions_);
  double before = 0;
  for (const ViewShare* view : active_)
    before += square_within(view->offers, view->fraction * budget_ms_);
  if (!at_once && squares > worth_a_change * before) return;
  for (size_t v = 0; v < active_.size(); ++v)
    active_[v]->fraction = fractions_[v];
}

// Gives each view whose tiles were not counted, or that has no part yet, an equal part; the others
// keep their proportions.
void BudgetDivision::make_room() noexcept {
  double counted = 0;
  double sum = 0;
  for (const ViewShare* view : active_)
    if (has_part(*view)) {
      counted += 1;
      sum += view->fraction;
    }
  const double equal = 1 / double(active_.size());
  for (ViewShare* view : active_)
    view->fraction = has_part(*view) ? view->fraction / sum * counted * equal : equal;
}

double BudgetDivision::share(ViewShare& view, double budget_ms, const Offers& offers, bool counted,
                             double seconds) noexcept {
  const bool again = view.round == round_;
  const bool repeats = std::exchange(view.repeats, false) && again;
  const bool new_round = again && !repeats;
  if (new_round) {
    ++round_;
    elapsed_s_ += seconds > 0 ? seconds : 1.0 / 60;
  }
  if (is_no_work(view.offers) && !is_no_work(offers)) { // it needs a part now
    changed_ = true;
    view.fraction = 0;
  }
  view.offers = offers;
  view.counted = counted;
  if (!repeats) {
    const uint64_t interval = round_ - view.round;
    view.interval = interval <= longest_interval ? interval : 0;
    view.round = round_;
  }
  list_active();
  const bool changed =
      std::exchange(changed_, false) || budget_ms != budget_ms_ || view.fraction <= 0;
  budget_ms_ = budget_ms;
  if (changed || new_round) divide_anew(changed);
  return view.fraction * budget_ms;
}

double BudgetDivision::present_share(const ViewShare& view, double budget_ms) const noexcept {
  const bool has_part = view.fraction > 0 && !is_no_work(view.offers);
  return (has_part ? view.fraction : 1 / double(views_.size())) * budget_ms;
}

} // namespace dermis::choice
