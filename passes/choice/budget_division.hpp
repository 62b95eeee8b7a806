#pragma once
// Divides one budget of device time among the views of a graph, so that the sum of their mean
// squared errors is least. The division changes at most once per second, and only if it becomes
// better: a view's own choice needs a budget that it can rely on.

#include "passes/choice/budget_controller.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::choice {

// A budget that a view could use, and the error that it would have then.
struct Offer {
  double ms = 0, rmse = 0;
};

// Offers of one view, by increasing budget and decreasing error.
struct Offers {
  std::array<Offer, 64> all;
  size_t count = 0; // 0: not known

  std::span<const Offer> list() const { return std::span(all).first(count); }
};

// Returns the offers of a view's configurations. The first one is the cheapest.
Offers make_offers(std::span<const Forecast> forecasts, const DecisionState& state);
// Returns the offer of a view in which nothing scatters: no error, in the time of what runs, or of
// the cheapest configuration if none does.
Offers offers_of_idle(std::span<const Forecast> forecasts, const DecisionState& state);
// Returns the offers of a view in which nothing runs.
Offers offers_of_no_work();

// The part of one view. Managed by BudgetDivision.
struct ViewShare {
  Offers offers;
  double fraction = 0;   // of the budget
  uint64_t round = 0;    // of its last frame; 0: none
  uint64_t interval = 0; // rounds between its last two frames; 0: longer than is waited for
  bool counted = false;  // its tiles were counted, so that its offers are known
  bool repeats = false;  // its last frame was not recorded, so that the next one replaces it
  bool active = false;   // the budget is divided among active views
};

// Returns the least sum of squared errors with which the offers fit into `budget_ms`, up to
// 1/256 of the budget per view, and writes each view's fraction of the budget, of which the sum is
// 1. If not even the cheapest offers fit, the fractions are in proportion to them. Each view has
// offers. Allocates nothing if `table` has division_table_size(views.size()) elements.
double divide(double budget_ms, std::span<ViewShare* const> views, std::span<double> table,
              std::span<double> fractions);
size_t division_table_size(size_t views);

// One object at a time per graph.
class BudgetDivision {
public:
  // Adds or removes a view, which must live until it is removed. Only add() allocates.
  void add(ViewShare& view);
  void remove(const ViewShare& view) noexcept;

  // Returns the milliseconds that the next frame of `view` may take, with these offers. `counted`:
  // the offers follow counted tiles. `seconds`: since the view's last frame. A round ends when a
  // view is recorded again: in each round the sum over all views is at most `budget_ms`, except
  // where a view returns that was not recorded in the last rounds. Allocates nothing.
  double share(ViewShare& view, double budget_ms, const Offers& offers, bool counted,
               double seconds) noexcept;
  // The view's last frame was discarded: its next frame belongs to the same round.
  void repeat(ViewShare& view) noexcept { view.repeats = true; }
  // Returns the same for the present division; of a view without frames, its equal part.
  double present_share(const ViewShare& view, double budget_ms) const noexcept;

private:
  void list_active() noexcept;
  void divide_anew(bool at_once) noexcept;
  void make_room() noexcept;

  std::vector<ViewShare*> views_, active_;
  bool changed_ = false; // other views are active than at the last division
  std::vector<double> table_, fractions_;
  double budget_ms_ = 0;
  double elapsed_s_ = 0; // since the last division
  uint64_t round_ = 0;
  bool divided_ = false; // by offers, not equally
};

} // namespace dermis::choice
