#pragma once
// Formats rows of dermis bench budget as text and plots.

#include "integration/tools/command/bench/choice/budget_judge.hpp"
#include "integration/tools/command/bench/report/report.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

std::vector<ReportColumn> budget_columns();

void add_budget_row(Report& report, const BudgetRow& row); // needs at least one timed run

// Adds plots of a scene's frame time and error over the budget.
void add_budget_plots(Report& report);

std::string text_of_budget(const Report& report);

} // namespace dermis::tools
