#include "integration/abi/memory_budget.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dermis::abi {
namespace {

// Memory of several plans of one view.
class ViewMemory {
public:
  explicit ViewMemory(HistoryMemory histories) : histories_(histories) {}
  void add(const PlanChoice& plan) {
    plans_.push_back(&plan.own.plan);
    if (plan.without_bounds) plans_.push_back(&plan.without_bounds->plan);
  }
  uint64_t bytes() const {
    const SharedHeaps heaps = share_heaps(plans_, histories_);
    return heaps.transient_bytes + heaps.history_bytes;
  }

private:
  HistoryMemory histories_;
  std::vector<const Plan*> plans_;
};

uint64_t bytes_of(const PlanChoice& plan, HistoryMemory histories) {
  ViewMemory memory(histories);
  memory.add(plan);
  return memory.bytes();
}

// Returns the geometric mean of the error over the usual sizes of d on the screen.
double rmse_of(const choice::ErrorModel& errors, const choice::Configuration& configuration) {
  constexpr double usual_d_px[] = {1, 4, 16};
  double product = 1;
  for (const double d_px : usual_d_px)
    product *= expected_rmse(errors, configuration.technique, {d_px});
  return std::cbrt(product);
}

std::string mebibytes(uint64_t bytes) {
  return fmt::format("{:.2f} MiB", double(bytes) / (1024 * 1024));
}

std::string list_names(const std::vector<std::string>& names) {
  constexpr size_t max_names = 3;
  const auto end = names.begin() + static_cast<ptrdiff_t>(std::min(names.size(), max_names));
  std::string text = fmt::format("'{}'", fmt::join(names.begin(), end, "', '"));
  if (names.size() > max_names) text += fmt::format(" and {} more", names.size() - max_names);
  return text;
}

SourceLocation place_in(const Graph& graph) {
  for (const SettingDeclaration& setting : graph.settings)
    if (setting.by_budget) return setting.where;
  return graph.passes.empty() ? SourceLocation{} : graph.passes.front().where;
}

} // namespace

void keep_within_memory(const Graph& graph, const choice::ErrorModel& errors,
                        const MemoryBudget& budget, std::vector<PlanChoice>& plans,
                        std::vector<choice::Configuration>& configurations,
                        Diagnostics& diagnostics) {
  // The errors of the configurations, and the least error of each plan.
  std::vector<double> rmse, plan_rmse(plans.size(), HUGE_VAL);
  for (const choice::Configuration& one : configurations) {
    rmse.push_back(rmse_of(errors, one));
    plan_rmse[one.plan] = std::min(plan_rmse[one.plan], rmse.back());
  }
  std::vector<size_t> order(plans.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return plan_rmse[a] < plan_rmse[b]; });
  std::vector<uint8_t> kept(plans.size(), 0);
  ViewMemory memory(budget.histories);
  for (const size_t p : order) {
    ViewMemory with = memory;
    with.add(plans[p]);
    if (with.bytes() > budget.bytes) continue;
    memory = with;
    kept[p] = 1;
  }
  const Plan& any = plans.front().own.plan;
  const std::string limit = fmt::format("the memory budget is {} for a view of {}x{}",
                                        mebibytes(budget.bytes), any.view_width, any.view_height);
  if (std::find(kept.begin(), kept.end(), 1) == kept.end()) {
    const auto smaller = [&](const PlanChoice& a, const PlanChoice& b) {
      return bytes_of(a, budget.histories) < bytes_of(b, budget.histories);
    };
    const auto smallest = std::min_element(plans.begin(), plans.end(), smaller);
    kept[static_cast<size_t>(smallest - plans.begin())] = 1;
    memory.add(*smallest);
    diagnostics.add(DiagnosticId::memory_exceeded, place_in(graph),
                    fmt::format("{}, and no plan fits; the smallest one runs and takes {}", limit,
                                mebibytes(memory.bytes())));
  }
  std::vector<std::string> removed;
  uint64_t min_bytes = UINT64_MAX;
  for (const choice::Configuration& one : configurations) {
    if (kept[one.plan] != 0) continue;
    removed.push_back(one.name);
    min_bytes = std::min(min_bytes, bytes_of(plans[one.plan], budget.histories));
  }
  if (removed.empty()) return;
  diagnostics.add(
      DiagnosticId::memory_left_out, place_in(graph),
      fmt::format("{}; not offered: {} (smallest plan: {}); the others take {} together", limit,
                  list_names(removed), mebibytes(min_bytes), mebibytes(memory.bytes())));

  // Remove them, and renumber the other plans.
  std::vector<uint32_t> number(plans.size());
  std::vector<PlanChoice> kept_plans;
  for (size_t p = 0; p < plans.size(); ++p) {
    number[p] = static_cast<uint32_t>(kept_plans.size());
    if (kept[p] != 0) kept_plans.push_back(std::move(plans[p]));
  }
  std::vector<choice::Configuration> kept_configurations;
  const bool default_fits = kept[configurations.front().plan] != 0;
  double min_rmse = HUGE_VAL;
  for (size_t i = 0; i < configurations.size(); ++i) {
    choice::Configuration& one = configurations[i];
    if (kept[one.plan] == 0) continue;
    one.plan = number[one.plan];
    kept_configurations.push_back(std::move(one));
    if (default_fits || rmse[i] >= min_rmse) continue;
    min_rmse = rmse[i];
    std::rotate(kept_configurations.begin(), kept_configurations.end() - 1,
                kept_configurations.end());
  }
  plans = std::move(kept_plans);
  configurations = std::move(kept_configurations);
}

} // namespace dermis::abi
