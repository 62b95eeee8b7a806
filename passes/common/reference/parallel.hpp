#pragma once
// Splits independent items over threads. The result of each item depends only on the item, so
// results never depend on the number of threads.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace dermis::subsurface {

// Calls work(i) once for every i in [0, count), on `threads` threads (0: one per hardware thread)
// that take `grain` items at a time. Returns when all are done. `work` must not throw.
template <class Work> void parallel_for(size_t count, size_t grain, unsigned threads, Work&& work) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  const size_t step = std::max<size_t>(1, grain);
  std::atomic<size_t> next{0};
  auto run = [&] {
    for (size_t first = next.fetch_add(step); first < count; first = next.fetch_add(step))
      for (size_t i = first; i < std::min(count, first + step); ++i)
        work(i);
  };
  std::vector<std::thread> others;
  const size_t useful = (count + step - 1) / step;
  for (size_t t = 1; t < std::min<size_t>(threads, useful); ++t)
    others.emplace_back(run);
  run();
  for (std::thread& t : others)
    t.join();
}

} // namespace dermis::subsurface
