#pragma once
// Packs items with lifetimes into one range of bytes (dynamic storage allocation). Knows nothing of
// graphs.

#include "framegraph/compile/compile.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dermis {

struct PackItem {
  uint64_t size = 0, alignment = 1; // bytes; alignment a power of two
  uint32_t first = 0, last = 0; // inclusive interval of pass positions in which the item is live
};

struct Packing {
  std::vector<uint64_t> offsets; // one per item
  uint64_t size = 0;             // bytes of the heap
  uint64_t lower_bound = 0;      // maximum of bytes live at once: no packing is smaller
};

// Items whose lifetimes overlap never share a byte. Every level stops if the lower bound is met.
// Equal items keep their order and effort is counted in steps, so the result is the same on every
// machine.
//
// fast: tightest gap, largest first; up to four other orders if much is left to gain. O(n log n + n
// live). tight: also the order of time, several orders with first and tightest gap, and a short
// search. optimize: as tight, with a longer search.
class Packer {
public:
  // Reuses the memory of `out` and of earlier calls.
  void pack(std::span<const PackItem> items, PackingLevel level, Packing& out);

private:
  struct Span {
    uint64_t begin = 0, end = 0;
    uint32_t item = 0;
  };
  struct Range {
    uint64_t begin = 0, end = 0;
  };
  struct Block { // items that are placed and live in block_passes consecutive positions, by begin
    std::vector<Range> ranges;
    std::vector<uint32_t>
        when; // positions of the block, as bits; same size as ranges, 0 from `count` on
    size_t count = 0;

    void clear();
    void insert(const Range& range, uint32_t positions);
  };
  enum class Fit : uint8_t { first, tightest };

  void find_bound(Packing& out);
  void place_by_time(Packing& out);
  uint64_t place_in_order(std::span<const uint32_t> order, Fit fit, uint64_t limit);
  uint64_t find_place(const PackItem& item, uint32_t first, uint32_t last, Fit fit);
  size_t gather(const Block& block, uint32_t positions, bool began, Range* to);
  bool try_order(std::span<const uint32_t> order, Fit fit, Packing& out);
  void sort_by_size(const std::vector<uint32_t>& given, std::vector<uint32_t>& sorted);
  void try_again(Packing& out);
  void stack(Packing& out);
  void by_weight(uint32_t a, uint32_t b, std::vector<uint32_t>& sorted);
  void try_orders(Packing& out);
  void search(uint64_t steps, Packing& out);

  std::span<const PackItem> items_;
  std::vector<int64_t> change_; // by position: bytes that become live less those that end
  std::vector<uint32_t> first_at_, last_at_, by_first_, by_last_;
  std::vector<Span> spans_;
  std::vector<Block> blocks_; // by position / block_passes
  std::vector<Range> gathered_;
  std::vector<uint64_t> sizes_;
  std::vector<uint32_t> size_class_; // by item: into sizes_
  std::vector<double> weights_;      // by item
  std::vector<uint64_t> offsets_;
  std::vector<uint32_t> by_size_, order_, best_order_;
  Fit best_fit_ = Fit::tightest;
  uint64_t steps_ = 0;
};

Packing pack_items(const std::vector<PackItem>& items, PackingLevel level = PackingLevel::tight);

} // namespace dermis
