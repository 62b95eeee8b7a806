// dermis bench supplement: reproduces table 1 of the 2021 paper's supplement from many runs, next
// to the printed values.

#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/supplement/experiment.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/statistics.hpp"

#include <fmt/format.h>

#include <cmath>

namespace dermis::tools {
namespace {

// Values printed in the supplement, and medians of 20,000 runs of an independent program (both:
// static, dynamic).
constexpr double printed[2][6] = {{0.0325, 0.0160, 0.0058, 0.0070, 0.0324, 0.0055},
                                  {0.5585, 0.3797, 0.3742, 0.1295, 0.0732, 0.1243}};
constexpr double medians[2][6] = {{0.0321, 0.0161, 0.0069, 0.0078, 0.0329, 0.0057},
                                  {0.5761, 0.3763, 0.3743, 0.1369, 0.0770, 0.1336}};
constexpr double median_tolerance = 0.015; // of the median, which is rounded to four digits
constexpr double printed_tolerance = 0.20; // of a single run, as printed

struct SupplementRow {
  std::string scenario, configuration;
  double value = 0, low = 0, high = 0; // median, 1 % and 99 %
  double expected = 0, paper = 0;
  bool holds = false;
};

// Emits six residuals of one kind of light.
demo::Result<> measure_residuals(const Emit<SupplementRow>& emit, bool dynamic, uint64_t runs,
                                 Progress& progress) {
  std::array<std::vector<double>, 6> all;
  for (uint64_t run = 0; run < runs; ++run) {
    if (interrupted()) return stopped();
    progress.update(dynamic ? runs + run : run);
    const auto values = run_supplement(dynamic, run);
    for (size_t k = 0; k < values.size(); ++k)
      all[k].push_back(values[k]);
  }
  for (size_t k = 0; k < all.size(); ++k) {
    SupplementRow row{dynamic ? "dynamic" : "static",
                      std::string(residual_names[k]),
                      median(all[k]),
                      quantile(all[k], 0.01),
                      quantile(all[k], 0.99),
                      medians[dynamic][k],
                      printed[dynamic][k]};
    constexpr double half_a_digit = 0.5e-4;
    row.holds =
        std::abs(row.value - row.expected) <= median_tolerance * row.expected + half_a_digit &&
        std::abs(row.paper / row.value - 1) <= printed_tolerance;
    emit(row);
  }
  return demo::success();
}

// Emits the best weight of the control: in closed form, as printed, and from samples.
void emit_weight(const Emit<SupplementRow>& emit, bool dynamic, double found, double printed_weight,
                 double tolerance) {
  const double expected = best_control_weight(dynamic);
  emit({dynamic ? "dynamic" : "static", "alpha", found, found, found, expected, printed_weight,
        std::abs(found - expected) <= tolerance});
}

demo::Result<> measure_supplement(SuiteRun& run, const Emit<SupplementRow>& emit) {
  const uint64_t runs = run.number("runs");
  run.add_info("runs", fmt::format("{} of 100 frames with 16 samples each", runs));
  Progress progress = run.progress("run", 2 * runs);
  for (const bool dynamic : {false, true})
    if (auto done = measure_residuals(emit, dynamic, runs, progress); !done) return done;
  constexpr uint32_t static_samples = 100000, dynamic_samples = 1024, dynamic_runs = 200;
  emit_weight(emit, false, sampled_control_weight(false, static_samples, 3), 0.477, 1e-3);
  double moving = 0;
  for (uint32_t i = 0; i < dynamic_runs; ++i)
    moving += sampled_control_weight(true, dynamic_samples, i) / dynamic_runs;
  emit_weight(emit, true, moving, 1.388, 3e-3);
  return demo::success();
}

} // namespace

Suite supplement_suite() {
  using Row = SupplementRow;
  return make_suite<Row>(
      {.name = "supplement",
       .what = "Reproduce table 1 of the control-variates supplement",
       .title = "Control variates: table 1 of the supplement",
       .summary = "Mean over frames 25 to 100 of the root of the moving variance of six residuals, "
                  "and the best "
                  "weight of the control. The printed values are those of one run.",
       .options = {{.name = "runs",
                    .help = "Runs of 100 frames",
                    .value = 4096u,
                    .minimum = 16,
                    .maximum = 1u << 20}}},
      {{"scenario", "light", &Row::scenario, {.groups = true}},
       {"configuration", "residual", &Row::configuration},
       {"median", "median", &Row::value, {4}},
       {"low", "1 %", &Row::low, {4}},
       {"high", "99 %", &Row::high, {4}},
       {"expected", "expected", &Row::expected, {4}},
       {"paper", "as printed", &Row::paper, {4}},
       {"paper_ratio", "printed / median", [](const Row& row) { return row.paper / row.value; }},
       {"holds", "holds", &Row::holds, {.goal = Goal::required}}},
      measure_supplement);
}

} // namespace dermis::tools
