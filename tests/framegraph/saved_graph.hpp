#pragma once
// The plan of a graph that has to compile, as it is saved.

#include "framegraph/serial/plan_file.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {

// Empty where the graph does not compile: the test has failed.
inline SavedPlan saved(const CompileInput& input) {
  Diagnostics diagnostics;
  const auto compiled = compile(input, diagnostics);
  EXPECT_TRUE(compiled) << format_as_json(diagnostics);
  return compiled ? saved_plan(input, compiled->plan) : SavedPlan{};
}

} // namespace dermis::testing
