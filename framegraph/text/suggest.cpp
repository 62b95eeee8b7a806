#include "framegraph/text/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <vector>

namespace dermis {

namespace {

constexpr size_t longest_compared = 64; // longer words are not typing mistakes
constexpr size_t longest_list = 12;
constexpr size_t most_compared = size_t{1} << 22; // pairs of characters, of all candidates

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

} // namespace

size_t edit_distance(std::string_view a, std::string_view b, size_t limit) {
  const size_t difference = a.size() > b.size() ? a.size() - b.size() : b.size() - a.size();
  if (difference > limit) return limit + 1;
  std::vector<size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (size_t j = 0; j <= b.size(); ++j)
    last[j] = j;
  for (size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0u : 1u)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1])) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last.swap(last);
    last.swap(row);
  }
  return std::min(last[b.size()], limit + 1);
}

std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates) {
  if (word.empty() || word.size() > longest_compared) return {};
  std::string_view best;
  size_t best_distance = word.size() / 3 + 2, left = most_compared;
  for (std::string_view candidate : candidates) {
    if (candidate.empty() || candidate.size() > longest_compared) continue;
    left -= std::min(left, word.size() * candidate.size());
    if (left == 0) break;
    const size_t distance = edit_distance(word, candidate, best_distance - 1);
    // A word that shares no characters with the candidate is not a typing mistake.
    if (distance < best_distance && distance < std::max(word.size(), candidate.size())) {
      best_distance = distance;
      best = candidate;
      if (distance == 0) break;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates) {
  const std::string_view best = nearest(word, candidates);
  return best.empty() ? std::string() : fmt::format("did you mean '{}'?", best);
}

std::string list_words(std::span<const std::string_view> words) {
  std::string out;
  const size_t shown = std::min(words.size(), longest_list);
  for (size_t i = 0; i < shown; ++i) {
    if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
    out += fmt::format("'{}'", words[i]);
  }
  if (shown < words.size()) out += ", ...";
  return out;
}

} // namespace dermis
