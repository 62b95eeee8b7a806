#pragma once
// Reads the files of a choice by budget.

#include "integration/examples/demo_engine/result.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "integration/tools/command/verbs.hpp"

namespace dermis::tools {

// Reads a file that may not be empty, because an empty text selects the library's. Path "":
// none.
demo::Result<demo::NamedText> read_named(const std::string& path);
demo::Result<demo::Budget> read_budget(const BudgetArguments& arguments);
// Returns the usage error if a budget is given but changes nothing in the graph of this file; else
// "".
std::string unused_budget(const BudgetArguments& arguments, const LoadedGraph& loaded,
                          const std::string& file);

} // namespace dermis::tools
