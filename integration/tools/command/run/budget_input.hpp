#pragma once
// Reads the files of a choice by budget.

#include "integration/examples/demo_engine/result.hpp"
#include "integration/tools/command/verbs.hpp"

namespace dermis::tools {

demo::Result<demo::Budget> read_budget(const BudgetArguments& arguments);

} // namespace dermis::tools
