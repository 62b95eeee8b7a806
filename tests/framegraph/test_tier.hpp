#pragma once
// How many random graphs a test tries: a quick number always, a large one in `./test.sh --full`.

#include <cstdint>
#include <cstdlib>

namespace dermis::testing {

inline uint64_t seeds_of_tier(uint64_t quick, uint64_t full) {
  return std::getenv("DERMIS_TESTS_FULL") != nullptr ? full : quick;
}

// Leaves a test to `./test.sh --full`, which another law of the quick run stands for.
#define DERMIS_IN_FULL_TIER()                                                                                \
  do {                                                                                                       \
    if (dermis::testing::seeds_of_tier(0, 1) == 0) GTEST_SKIP() << "with DERMIS_TESTS_FULL";                 \
  } while (false)

} // namespace dermis::testing
