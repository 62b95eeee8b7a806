#pragma once
// Caches compiled plans by the whole key of their input, so that a setting that switches back and
// forth compiles once per value.

#include "framegraph/serialize/plan_key.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dermis {

inline constexpr size_t plan_cache_capacity = 8; // plans; the least recently used plan is dropped

// Pure data: copies are independent. One thread at a time.
struct PlanCache {
  struct Entry {
    std::string key; // key_bytes(), and whether reasons were collected
    CompiledPlan compiled;
  };
  std::vector<Entry> entries; // the most recently used entry is last
  uint64_t hits = 0, misses = 0;
};

// Returns the result of compile(), from the cache if it has the whole key. Inputs that compile with
// messages are not cached, so that each call reports the messages.
std::optional<CompiledPlan> compile(const CompileInput& input, PlanCache& cache,
                                    Diagnostics& diagnostics);

} // namespace dermis
