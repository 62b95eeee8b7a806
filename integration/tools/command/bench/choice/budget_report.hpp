#pragma once
// Rows of dermis bench budget as text and plots.

#include "integration/tools/command/bench/choice/budget_judge.hpp"
#include "integration/tools/command/bench/report/report.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

std::vector<ReportColumn> budget_columns();

void add_budget_row(Report& report, const BudgetRow& row); // of at least one timed run

// What a scene's frames take and how far they are from the truth, over the budget.
void add_budget_plots(Report& report);

std::string text_of_budget(const Report& report);

} // namespace dermis::tools
