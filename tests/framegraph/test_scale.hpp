#pragma once
// Returns how many random graphs a test tries: few by default, many in `./test.sh --full`.

#include <cstdint>
#include <cstdlib>

namespace dermis::testing {

inline uint64_t seeds_to_try(uint64_t quick, uint64_t full) {
  return std::getenv("DERMIS_TESTS_FULL") != nullptr ? full : quick;
}

// Skips a test except in `./test.sh --full`. Another property covers the code in the quick run.
#define DERMIS_FULL_TESTS_ONLY()                                                                   \
  do {                                                                                             \
    if (dermis::testing::seeds_to_try(0, 1) == 0) GTEST_SKIP() << "with DERMIS_TESTS_FULL";        \
  } while (false)

} // namespace dermis::testing
