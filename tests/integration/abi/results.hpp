#pragma once
// Checks of results of the C interface together with the message of dermis_last_error().

#include "tests/support/matchers.hpp"

#include <dermis/dermis.h>

#include <string>

#define EXPECT_OK(call) EXPECT_EQ(call, DERMIS_OK) << dermis_last_error()
#define ASSERT_OK(call) ASSERT_EQ(call, DERMIS_OK) << dermis_last_error()

namespace dermis::abi_test {

inline std::string last_error() {
  const char* text = dermis_last_error();
  return text != nullptr ? text : "";
}

// Matches `result` if dermis_last_error() contains all texts and satisfies all matchers.
template <class... Texts> auto Fails(dermis_result result, const Texts&... texts) {
  return AllOf(::testing::Eq(result),
               ::testing::ResultOf(
                   "the last error", [](dermis_result) { return last_error(); }, HasAll(texts...)));
}

} // namespace dermis::abi_test
