#include "integration/tools/command/expect/text_diff.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dermis::tools {
namespace {

// bounds the table below, whose size is the product of both sides
constexpr size_t max_lines = 4096;

using Lines = std::vector<std::string_view>;

Lines lines_of(std::string_view text) {
  Lines lines;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

void append(std::string& out, const char* mark, std::string_view line) {
  out.append(mark).append(line).append("\n");
}

// Computes a longest common subsequence with a table of lengths (Wagner and Fischer 1974,
// insertions and deletions only), over lines [first, end) of both.
void diff_middle(const Lines& before, const Lines& after, size_t first, size_t before_end,
                 size_t after_end, std::string& out) {
  const size_t rows = before_end - first, columns = after_end - first;
  const bool too_long = rows > max_lines || columns > max_lines;
  std::vector<uint16_t> common(too_long ? 0 : (rows + 1) * (columns + 1), 0);
  const auto at = [&](size_t r, size_t c) -> uint16_t& { return common[r * (columns + 1) + c]; };
  for (size_t r = rows; !too_long && r-- > 0;)
    for (size_t c = columns; c-- > 0;)
      at(r, c) = before[first + r] == after[first + c] ? static_cast<uint16_t>(at(r + 1, c + 1) + 1)
                                                       : std::max(at(r + 1, c), at(r, c + 1));
  size_t r = 0, c = 0;
  while (r < rows || c < columns) {
    const bool both = !too_long && r < rows && c < columns;
    if (both && before[first + r] == after[first + c]) {
      append(out, "  ", before[first + r]);
      ++r, ++c;
    } else if (r < rows && (!both || at(r + 1, c) >= at(r, c + 1))) {
      append(out, "- ", before[first + r++]);
    } else {
      append(out, "+ ", after[first + c++]);
    }
  }
}

} // namespace

std::string diff_lines(std::string_view before_text, std::string_view after_text) {
  const Lines before = lines_of(before_text), after = lines_of(after_text);
  const size_t shorter = std::min(before.size(), after.size());
  size_t head = 0, tail = 0;
  while (head < shorter && before[head] == after[head])
    ++head;
  while (tail < shorter - head &&
         before[before.size() - 1 - tail] == after[after.size() - 1 - tail])
    ++tail;
  std::string out;
  for (size_t i = 0; i < head; ++i)
    append(out, "  ", before[i]);
  diff_middle(before, after, head, before.size() - tail, after.size() - tail, out);
  for (size_t i = before.size() - tail; i < before.size(); ++i)
    append(out, "  ", before[i]);
  return out;
}

} // namespace dermis::tools
