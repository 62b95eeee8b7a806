#pragma once
// Returns the saved plan of a graph that has to compile.

#include "framegraph/serialize/plan_file.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {

// Returns an empty plan and fails the test if the graph does not compile.
inline SavedPlan saved(const CompileInput& input) {
  Diagnostics diagnostics;
  const auto compiled = compile(input, diagnostics);
  EXPECT_TRUE(compiled) << format_as_json(diagnostics);
  return compiled ? saved_plan(input, compiled->plan) : SavedPlan{};
}

} // namespace dermis::testing
