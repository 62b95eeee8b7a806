#include "framegraph/serialize/plan_cache.hpp"

#include <algorithm>

namespace dermis {

std::optional<CompiledPlan> compile(const CompileInput& input, PlanCache& cache,
                                    Diagnostics& diagnostics) {
  std::string key = key_bytes(plan_key(input));
  key.push_back(input.reasons ? '\1' : '\0');
  const auto found = std::find_if(cache.entries.begin(), cache.entries.end(),
                                  [&](const PlanCache::Entry& entry) { return entry.key == key; });
  if (found != cache.entries.end()) {
    ++cache.hits;
    std::rotate(found, found + 1, cache.entries.end());
    return cache.entries.back().compiled;
  }
  ++cache.misses;
  const size_t messages = diagnostics.list.size();
  std::optional<CompiledPlan> compiled = compile(input, diagnostics);
  if (!compiled || diagnostics.list.size() != messages) return compiled;
  if (cache.entries.size() == plan_cache_capacity) cache.entries.erase(cache.entries.begin());
  cache.entries.push_back({std::move(key), *compiled});
  return compiled;
}

} // namespace dermis
