#pragma once
// Describes a change that breaks the graph of model_support.hpp, and checks that it gives exactly
// one diagnostic, at the place of the change, with all expected words.

#include "tests/framegraph/model_support.hpp"

#include <algorithm>

namespace dermis::testing {

struct Damage {
  const char* property; // Also the name of the test.
  const char *from, *to;
  DiagnosticId id;
  const char* at; // Occurs once in the changed text; the diagnostic points at its beginning.
  std::vector<std::string> words;
};

inline void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.to;
}

inline std::string property_of(const ::testing::TestParamInfo<Damage>& one) {
  return one.param.property;
}

// Expects one diagnostic, at the place of `damage`.
inline void expect_one_diagnostic(const Damage& damage) {
  const std::string text = damaged(damage.from, damage.to);
  const size_t at = text.find(damage.at);
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(text.find(damage.at, at + 1), std::string::npos) << "ambiguous";
  const std::string before = text.substr(0, at);
  const auto line = static_cast<uint32_t>(1 + std::count(before.begin(), before.end(), '\n'));
  const auto column =
      // On the first line rfind gives npos, and npos + 1 = 0.
      static_cast<uint32_t>(at - (before.rfind('\n') + 1) + 1);
  const Read result = read(text);
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, damage.id, line, column, damage.words);
}

} // namespace dermis::testing
