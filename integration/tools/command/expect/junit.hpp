#pragma once
// Results as JUnit XML, the form that build servers read.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

struct TestResult {
  std::string name;
  bool ok = false;
  std::string message; // why not, one line
  std::string details; // the rest of it
};

struct TestSuite {
  std::string name;
  std::vector<TestResult> results;
};

// Text as XML content or attribute value: markup escaped, characters that XML 1.0 cannot hold as '?'.
std::string xml_text(std::string_view text);

// A whole document. It holds no times, so that equal results give equal bytes.
std::string junit_xml(const std::vector<TestSuite>& suites);

} // namespace dermis::tools
