#pragma once
// Parses a text in a test and finds the one expected diagnostic.

#include "framegraph/text/document.hpp"
#include "tests/support/matchers.hpp"

#include <algorithm>
#include <string>
#include <vector>

namespace dermis::testing {

struct Parsed {
  Diagnostics diagnostics;
  std::optional<Document> document;
};

inline Parsed parse(std::string text) {
  Parsed out;
  out.document = parse_document("test.json", std::move(text), out.diagnostics);
  return out;
}

inline std::string all_messages(const Diagnostics& diagnostics) {
  std::string out;
  for (const Diagnostic& one : diagnostics.list)
    out += format_for_people(diagnostics, one) + "\n";
  return out;
}

// Expects exactly one diagnostic, with this id and place, whose text contains each of `words`.
inline void expect_only(const Diagnostics& diagnostics, DiagnosticId id, uint32_t line,
                        uint32_t column, const std::vector<std::string>& words = {}) {
  ASSERT_EQ(diagnostics.list.size(), 1u) << all_messages(diagnostics);
  const Diagnostic& one = diagnostics.list[0];
  EXPECT_EQ(diagnostic_info(one.id).name, diagnostic_info(id).name) << all_messages(diagnostics);
  EXPECT_EQ(one.where.line, line) << all_messages(diagnostics);
  EXPECT_EQ(one.where.column, column) << all_messages(diagnostics);
  const std::string whole = format_for_people(diagnostics, one);
  for (const std::string& word : words)
    EXPECT_NE(whole.find(word), std::string::npos) << word << "\n" << whole;
}

// Expects that the text is not a document, for one reason as in expect_only().
inline void expect_rejected(const std::string& text, DiagnosticId id, uint32_t line,
                            uint32_t column, const std::vector<std::string>& words = {}) {
  const Parsed parsed = parse(text);
  EXPECT_FALSE(parsed.document);
  expect_only(parsed.diagnostics, id, line, column, words);
}

} // namespace dermis::testing
