#include "integration/tools/command/expect/junit.hpp"

#include "framegraph/text/utf8.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

int64_t failures_of(const TestSuite& suite) {
  return std::count_if(suite.results.begin(), suite.results.end(),
                       [](const TestResult& one) { return !one.ok; });
}

} // namespace

std::string xml_text(std::string_view text) {
  std::string out;
  for (size_t at = 0; at < text.size(); ++at) {
    const char c = text[at];
    const auto code = static_cast<unsigned char>(c);
    const size_t bytes = utf8_sequence_bytes(text.substr(at, 4));
    if (bytes > 1) {
      out += text.substr(at, bytes);
      at += bytes - 1;
    } else if (bytes == 0) {
      out += '?';
    } else if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\n' || c == '\t')
      out += c;
    else
      out += code < 0x20 || code == 0x7f ? '?' : c;
  }
  return out;
}

std::string junit_xml(const std::vector<TestSuite>& suites) {
  size_t tests = 0;
  int64_t failures = 0;
  for (const TestSuite& suite : suites) {
    tests += suite.results.size();
    failures += failures_of(suite);
  }
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  out += fmt::format("<testsuites name=\"dermis test\" tests=\"{}\" failures=\"{}\">\n", tests,
                     failures);
  for (const TestSuite& suite : suites) {
    const std::string name = xml_text(suite.name);
    out += fmt::format("  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\">\n", name,
                       suite.results.size(), failures_of(suite));
    for (const TestResult& one : suite.results) {
      out += fmt::format("    <testcase classname=\"{}\" name=\"{}\"", name, xml_text(one.name));
      out += one.ok
                 ? "/>\n"
                 : fmt::format(">\n      <failure message=\"{}\">{}</failure>\n    </testcase>\n",
                               xml_text(one.message), xml_text(one.details));
    }
    out += "  </testsuite>\n";
  }
  return out + "</testsuites>\n";
}

} // namespace dermis::tools
