#pragma once
// Matchers of GoogleTest that tests use without their namespace, and a matcher for several texts.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <type_traits>

namespace dermis {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::FloatEq;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

// Returns a matcher for strings that contain a text; a matcher is returned unchanged.
template <class T> auto matcher_of(const T& text) {
  if constexpr (std::is_convertible_v<T, std::string>)
    return HasSubstr(text);
  else
    return text;
}

// Matches a string that contains all texts and satisfies all matchers of the arguments.
template <class... Texts> auto HasAll(const Texts&... texts) {
  return AllOf(matcher_of(texts)...);
}

} // namespace dermis
