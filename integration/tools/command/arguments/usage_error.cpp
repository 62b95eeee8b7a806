#include "integration/tools/command/arguments/usage_error.hpp"

#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <regex>
#include <vector>

namespace dermis::tools {
namespace {

// CLI11 prints a limit of a real number with six decimals.
std::string shortest(const std::string& number) {
  return fmt::format("{}", std::strtod(number.c_str(), nullptr));
}

std::string wrong_word(const std::string& option, const std::string& found,
                       const std::string& list) {
  std::vector<std::string_view> words;
  for (size_t at = 0; at < list.size();) {
    const size_t end = std::min(list.find(',', at), list.size());
    words.push_back(std::string_view(list).substr(at, end - at));
    at = end + 1;
  }
  return fmt::format("{}: expected {}, found '{}'", option, list_words(words), found);
}

} // namespace

std::string reword_usage_error(const std::string& text, std::string_view verb) {
  static const std::regex required("(\\S+) is required"),
      range("(\\S+): Value (.*) not in range (\\S+) to (\\S+)"),
      set("(\\S+): (.*) not in \\{(.*)\\}"), no_value("(\\S+): 1 required .* missing"),
      repeated("(\\S+): At Most 1 required but received .*"),
      unexpected("The following arguments? (?:was|were) not expected: (.*)");
  std::smatch parts;
  const auto is = [&](const std::regex& form) { return std::regex_match(text, parts, form); };
  const auto part = [&](size_t i) { return parts[i].str(); };
  const std::string help = fmt::format("'dermis {} --help'", verb);
  if (is(required))
    return fmt::format("{} is required; {} describes it and shows an example",
                       part(1).starts_with("-") ? part(1) : fmt::format("argument '{}'", part(1)),
                       help);
  if (is(range))
    return fmt::format("{}: expected a number from {} to {}, found '{}'", part(1),
                       shortest(part(3)), shortest(part(4)), part(2));
  if (is(set)) return wrong_word(part(1), part(2), part(3));
  if (is(no_value)) return fmt::format("{}: the value is missing; {} describes it", part(1), help);
  if (is(repeated)) return fmt::format("{} may be given only once", part(1));
  if (is(unexpected))
    return fmt::format("unexpected argument '{}'; {} lists the arguments", part(1), help);
  return text;
}

} // namespace dermis::tools
