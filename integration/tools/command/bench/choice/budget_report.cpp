#include "integration/tools/command/bench/choice/budget_report.hpp"

#include "integration/tools/command/present.hpp"

#include <fmt/format.h>

namespace dermis::tools {
namespace {

std::string cell(const ReportValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{:.3g}", *number);
  if (const auto* count = std::get_if<int64_t>(&value)) return fmt::format("{}", *count);
  return "-";
}

} // namespace

std::vector<ReportColumn> budget_columns() {
  return {
      {"scene", "scene"},
      {"x", "x"},
      {"budget_ms", "budget, ms"},
      {"mean_ms", "mean, ms"},
      {"p95_ms", "95 %, ms"},
      {"over_budget_fraction", "over, timed", 2},
      {"over_budget_fraction_meter", "over, meter", 2},
      {"mean_rmse", "RMSE"},
      {"best_single_rmse_within_budget", "best single RMSE"},
      {"best_single", "best single"},
      {"switches", "switches"},
  };
}

void add_budget_row(Report& report, const BudgetRow& row) {
  const TimedFigures timed = median_of(row.timed);
  report.table.rows.push_back({row.scene, row.x, row.budget_ms, timed.mean_ms, timed.p95_ms, timed.over,
                               row.over_model, row.rmse,
                               row.single_rmse ? ReportValue(*row.single_rmse) : ReportValue(), row.single,
                               static_cast<int64_t>(timed.switches)});
}

void add_budget_plots(Report& report) {
  Plot time{"mean device time of a frame", "budget, ms", "ms", {}};
  Plot error{"error", "budget, ms", "RMSE of linear luminance", {}};
  for (size_t row = 0; row < report.table.rows.size(); ++row) {
    const auto number = [&](std::string_view key) { return std::get<double>(report.table.at(row, key)); };
    const std::string& scene = std::get<std::string>(report.table.at(row, "scene"));
    if (time.series.empty() || time.series.back().name != scene) {
      time.series.push_back({scene, {}});
      error.series.push_back({scene, {}});
    }
    const std::string label = fmt::format("{} within {:.2f} ms: {:.2f} ms, RMSE {:.5f}", scene,
                                          number("budget_ms"), number("mean_ms"), number("mean_rmse"));
    time.series.back().points.push_back({number("budget_ms"), number("mean_ms"), label, false});
    error.series.back().points.push_back({number("budget_ms"), number("mean_rmse"), label, false});
  }
  report.plots = {time, error};
  report.plots_title = "Over the budget";
  report.plots_text = "Point at a budget to see the time and error of its frames.";
}

std::string text_of_budget(const Report& report) {
  Table table;
  for (const ReportColumn& column : report.table.columns)
    table.columns.push_back({column.title, column.key != "scene" && column.key != "best_single"});
  for (const auto& row : report.table.rows) {
    auto& cells = table.rows.emplace_back();
    for (const ReportValue& value : row)
      cells.push_back(cell(value));
  }
  return format_table(table);
}

} // namespace dermis::tools
