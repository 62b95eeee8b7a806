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

inline Damage damage(const char* property, const char* from, const char* to, DiagnosticId id,
                     const char* at, std::vector<std::string> words) {
  return {property, from, to, id, at, std::move(words)};
}

inline void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.to;
}

inline std::string property_of(const ::testing::TestParamInfo<Damage>& one) {
  return one.param.property;
}

// Expects one diagnostic, where `damage.at` first occurs in `text`.
inline void expect_damage(const Damage& damage, const std::string& text,
                          const Diagnostics& diagnostics) {
  const size_t at = text.find(damage.at);
  ASSERT_NE(at, std::string::npos);
  const std::string before = text.substr(0, at);
  const auto line = static_cast<uint32_t>(1 + std::count(before.begin(), before.end(), '\n'));
  // On the first line rfind gives npos, and npos + 1 = 0.
  const auto column = static_cast<uint32_t>(at - (before.rfind('\n') + 1) + 1);
  expect_only(diagnostics, damage.id, line, column, damage.words);
}

// Damages the whole graph and expects one diagnostic at the only place of `damage.at`.
inline void expect_one_diagnostic(const Damage& damage) {
  const std::string text = damaged(damage.from, damage.to);
  EXPECT_EQ(text.find(damage.at), text.rfind(damage.at)) << "ambiguous";
  const Read result = read(text);
  EXPECT_FALSE(result.graph);
  expect_damage(damage, text, result.diagnostics);
}

} // namespace dermis::testing
