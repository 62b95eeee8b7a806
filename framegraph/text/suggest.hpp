#pragma once
// "Did you mean": the nearest of the words that would have been right.

#include <span>
#include <string>
#include <string_view>

namespace dermis {

// Insertions, deletions, substitutions and swaps of neighbours that turn `a` into `b` (optimal string
// alignment distance), compared byte by byte without regard to ASCII case. Stops counting above `limit`:
// returns limit + 1.
size_t edit_distance(std::string_view a, std::string_view b, size_t limit);

// The candidate nearest to `word`, the first of equals; empty when none is within a third of its length + 1.
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);

// "did you mean 'size'?", or the empty string.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates);

// "'a', 'b' or 'c'", for messages that list what would have been right; at most 12, then "...".
std::string list_words(std::span<const std::string_view> words);

} // namespace dermis
