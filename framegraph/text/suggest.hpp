#pragma once
// Finds suggestions for "did you mean": the nearest of the valid words.

#include <span>
#include <string>
#include <string_view>

namespace dermis {

// Returns the number of insertions, deletions, substitutions and swaps of neighbours that turn `a`
// into `b` (optimal string alignment distance). Compares bytes and ignores ASCII case. Returns
// limit + 1 if the distance exceeds `limit`.
size_t edit_distance(std::string_view a, std::string_view b, size_t limit);

// Returns the candidate nearest to `word`, the first of equals; empty if none is within a third of
// its length + 1.
std::string_view nearest(std::string_view word, std::span<const std::string_view> candidates);

// Returns "did you mean 'size'?", or the empty string.
std::string did_you_mean(std::string_view word, std::span<const std::string_view> candidates);

// Returns "'a', 'b' or 'c'" for messages that list valid words; at most 12, then "...".
std::string list_words(std::span<const std::string_view> words);

} // namespace dermis
