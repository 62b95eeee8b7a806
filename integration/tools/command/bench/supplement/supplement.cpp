// dermis bench supplement: reproduces table 1 of the 2021 paper's supplement from many runs, next
// to the printed values.

#include "integration/tools/command/bench/report/report.hpp"
#include "integration/tools/command/bench/supplement/experiment.hpp"
#include "integration/tools/command/interrupt.hpp"
#include "integration/tools/command/verbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dermis::tools {
namespace {

// Values printed in the supplement, and medians of 20,000 runs of an independent program (both:
// static, dynamic).
constexpr double printed[2][6] = {{.0325, .0160, .0058, .0070, .0324, .0055},
                                  {.5585, .3797, .3742, .1295, .0732, .1243}};
constexpr double medians[2][6] = {{.0321, .0161, .0069, .0078, .0329, .0057},
                                  {.5761, .3763, .3743, .1369, .0770, .1336}};
constexpr double median_tolerance = 0.015; // of the median, which is rounded to four digits
constexpr double printed_tolerance = 0.20; // of a single run, as printed

struct Row {
  std::string scenario, configuration;
  double value = 0, low = 0, high = 0; // median, 1 % and 99 %
  double expected = 0, paper = 0, tolerance = 0;
  bool holds = false;
};

// Returns an empty list if interrupted.
std::vector<Row> table_rows(const Session& session, uint32_t runs) {
  std::vector<Row> rows;
  Progress progress(progress_style(session.quiet, false), "supplement", "run", uint64_t{2} * runs);
  for (const bool dynamic : {false, true}) {
    std::array<std::vector<double>, 6> all;
    for (uint32_t run = 0; run < runs; ++run) {
      if (interrupted()) return {};
      progress.update(dynamic ? uint64_t{runs} + run : run);
      const auto values = run_supplement(dynamic, run);
      for (size_t k = 0; k < values.size(); ++k)
        all[k].push_back(values[k]);
    }
    for (size_t k = 0; k < all.size(); ++k) {
      std::sort(all[k].begin(), all[k].end());
      const auto at = [&](double fraction) {
        return all[k][static_cast<size_t>(fraction * (runs - 1) + 0.5)];
      };
      Row row{dynamic ? "dynamic" : "static",
              std::string(residual_names[k]),
              at(0.5),
              at(0.01),
              at(0.99),
              medians[dynamic][k],
              printed[dynamic][k],
              median_tolerance,
              false};
      constexpr double half_a_digit = 0.5e-4;
      row.holds = std::abs(row.value - row.expected) <= median_tolerance * row.expected + half_a_digit &&
                  std::abs(row.paper / row.value - 1) <= printed_tolerance;
      rows.push_back(row);
    }
  }
  return rows;
}

// Returns the best weight of the control: in closed form, as printed, and from samples.
std::vector<Row> weight_rows() {
  constexpr uint32_t static_samples = 100000, dynamic_samples = 1024, dynamic_runs = 200;
  Row still{"static", "alpha", sampled_control_weight(false, static_samples, 3),
            0,        0,       best_control_weight(false),
            .477,     1e-3,    false};
  Row moving{"dynamic", "alpha", 0, 0, 0, best_control_weight(true), 1.388, 3e-3, false};
  for (uint32_t run = 0; run < dynamic_runs; ++run)
    moving.value += sampled_control_weight(true, dynamic_samples, run) / dynamic_runs;
  std::vector<Row> rows = {still, moving};
  for (Row& row : rows) {
    row.low = row.high = row.value;
    row.holds = std::abs(row.value - row.expected) <= row.tolerance;
  }
  return rows;
}

Report make_report(const Session& session, const std::vector<Row>& rows, uint32_t runs) {
  Report report;
  report.bench = "supplement";
  report.title = "Control variates: table 1 of the supplement";
  report.summary =
      "Mean over frames 25 to 100 of the root of the moving variance of six residuals, and the best "
      "weight of the control. The printed values are those of one run.";
  report.info = machine_info(session.command, "");
  report.info.emplace_back("runs", fmt::format("{} of 100 frames with 16 samples each", runs));
  report.table.columns = {{"scenario", "light"},      {"configuration", "residual"},
                          {"median", "median", 4},    {"low", "1 %", 4},
                          {"high", "99 %", 4},        {"expected", "expected", 4},
                          {"paper", "as printed", 4}, {"paper_ratio", "printed / median"},
                          {"holds", "holds"}};
  for (const Row& row : rows)
    report.table.rows.push_back({row.scenario, row.configuration, row.value, row.low, row.high, row.expected,
                                 row.paper, row.paper / row.value, row.holds});
  return report;
}

std::string text_of(const std::vector<Row>& rows) {
  Table table;
  table.columns = {{"light"},          {"residual"},         {"median", true}, {"1 % .. 99 %", true},
                   {"expected", true}, {"as printed", true}, {"holds"}};
  for (const Row& row : rows)
    table.rows.push_back({row.scenario, row.configuration, fmt::format("{:.4f}", row.value),
                          fmt::format("{:.4f} .. {:.4f}", row.low, row.high),
                          fmt::format("{:.4f}", row.expected), fmt::format("{:.4f}", row.paper),
                          row.holds ? "yes" : "NO"});
  return format_table(table);
}

} // namespace

ExitCode bench_supplement(const Session& session, const BenchSupplementOptions& options) {
  std::vector<Row> rows = table_rows(session, options.runs);
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  const std::vector<Row> weights = weight_rows();
  rows.insert(rows.end(), weights.begin(), weights.end());
  if (interrupted()) return fail(session, ExitCode::interrupted, "stopped");
  const auto broken = std::count_if(rows.begin(), rows.end(), [](const Row& row) { return !row.holds; });
  const Report report = make_report(session, rows, options.runs);
  if (!session.quiet && options.json != "-" && options.html != "-")
    print(text_of(rows) + fmt::format("{} of {} rows do not hold\n", broken, rows.size()));
  const std::string problem = deliver_report(report, options.json, "", options.html);
  if (!problem.empty()) return fail(session, ExitCode::environment, problem);
  return broken == 0 ? ExitCode::ok : ExitCode::problems;
}

} // namespace dermis::tools
