#pragma once
// Where in memory each instance lies. Pure data in, pure data out: intervals in time become intervals in
// bytes.

#include <cstdint>
#include <vector>

namespace dermis {

struct PackItem {
  uint64_t size = 0, alignment = 1; // bytes; alignment a power of two
  uint32_t first = 0, last = 0;     // inclusive interval of pass positions in which the contents matter
};

struct Packing {
  std::vector<uint64_t> offsets; // one per item
  uint64_t size = 0;             // bytes of the heap
  uint64_t lower_bound = 0;      // most bytes alive at once: no packing is smaller
};

// Items whose intervals meet never share a byte. Places items one at a time into the tightest gap that fits,
// largest first and by first use, and keeps the smaller result; equal items keep their order, so the result
// is the same on every machine. O(n^2 log n).
Packing pack_items(const std::vector<PackItem>& items);

} // namespace dermis
