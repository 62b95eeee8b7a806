#pragma once
// Plans that were compiled before, by the whole key of what they were compiled from: a setting that flips
// back and forth compiles once for each side.

#include "framegraph/serial/plan_key.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis {

inline constexpr size_t plan_cache_capacity = 8; // plans; the one that was not used for longest is dropped

// Pure data: copies are independent. One thread at a time.
struct PlanCache {
  struct Entry {
    std::string key; // key_bytes(), and whether reasons were collected
    CompiledPlan compiled;
  };
  std::vector<Entry> entries; // the one used last stands last
  uint64_t hits = 0, misses = 0;
};

// The same as compile(), from the cache where the whole key is there. Inputs that compile with messages are
// compiled each time, so that the messages are told each time.
std::optional<CompiledPlan> compile(const CompileInput& input, PlanCache& cache, Diagnostics& diagnostics);

} // namespace dermis
