#pragma once
// Writes results as JUnit XML, the format that CI servers read.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

struct TestResult {
  std::string name;
  bool ok = false;
  std::string message; // reason of the failure, one line
  std::string details; // further lines
};

struct TestSuite {
  std::string name;
  std::vector<TestResult> results;
};

// Escapes text for XML content or attribute values. Characters that XML 1.0 cannot represent become
// '?'.
std::string xml_text(std::string_view text);

// Returns a whole document. It contains no times, so that equal results give equal bytes.
std::string junit_xml(const std::vector<TestSuite>& suites);

} // namespace dermis::tools
