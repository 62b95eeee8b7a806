// Dynamic storage allocation by first fit and tightest fit in several orders, with a local search.

#include "framegraph/compile/packer.hpp"
#include "framegraph/compile/hardware.hpp"
#include "framegraph/model/splitmix.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace dermis {
namespace {

// Limits of comparisons of two items. A comparison takes about 1 ns, several in graphs larger than
// the caches.
constexpr uint64_t tight_steps_per_item = 10'000;
constexpr uint64_t max_tight_steps = 25'000'000;
constexpr uint64_t optimize_steps = 1'000'000'000;
constexpr uint32_t block_passes = 24; // positions that share one list of live items: below 32
constexpr uint32_t began_before =
    0x80000000; // flag next to the bits of positions: live before the block
constexpr uint64_t unlimited = UINT64_MAX;

uint64_t align_to_power_of_two(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) & ~(alignment - 1);
}

// Sorts the indices of `count` items stably by key(i).
template <class Key>
void counting_sort(uint32_t count, uint32_t keys, std::vector<uint32_t>& starts,
                   std::vector<uint32_t>& sorted, Key key) {
  starts.assign(size_t{keys} + 1, 0);
  for (uint32_t i = 0; i < count; ++i)
    ++starts[key(i) + 1];
  for (uint32_t k = 0; k < keys; ++k)
    starts[k + 1] += starts[k];
  sorted.resize(count);
  for (uint32_t i = 0; i < count; ++i)
    sorted[starts[key(i)]++] = i;
}

} // namespace

void Packer::find_bound(Packing& out) {
  uint32_t positions = 0;
  for (const PackItem& item : items_)
    positions = std::max(positions, item.last + 1);
  change_.assign(size_t{positions} + 1, 0);
  for (const PackItem& item : items_) {
    change_[item.first] += static_cast<int64_t>(item.size);
    change_[item.last + 1] -= static_cast<int64_t>(item.size);
  }
  int64_t alive = 0, maximum = 0;
  for (const int64_t change : change_)
    maximum = std::max(maximum, alive += change);
  out.lower_bound = static_cast<uint64_t>(maximum);
}

// Places items in the order of time: ended items free their bytes, new items take the tightest gap.
void Packer::place_by_time(Packing& out) {
  const auto count = static_cast<uint32_t>(items_.size());
  const auto positions = static_cast<uint32_t>(change_.size());
  counting_sort(count, positions, first_at_, by_first_,
                [&](uint32_t i) { return items_[i].first; });
  counting_sort(count, positions, last_at_, by_last_, [&](uint32_t i) { return items_[i].last; });
  spans_.clear();
  uint64_t size = 0;
  uint32_t over = 0;
  for (uint32_t begin = 0; begin < count;) {
    const uint32_t now = items_[by_first_[begin]].first;
    uint32_t end = begin;
    while (end < count && items_[by_first_[end]].first == now)
      ++end;
    for (uint32_t i = begin + 1; i < end;
         ++i) // few begin together: insertion sort, the largest first
      for (uint32_t at = i;
           at > begin && items_[by_first_[at]].size > items_[by_first_[at - 1]].size; --at)
        std::swap(by_first_[at], by_first_[at - 1]);
    for (; over < count && items_[by_last_[over]].last < now; ++over) {
      const uint32_t ended = by_last_[over];
      const auto at =
          std::lower_bound(spans_.begin(), spans_.end(), offsets_[ended],
                           [](const Span& span, uint64_t offset) { return span.begin < offset; });
      spans_.erase(at);
    }
    for (; begin < end; ++begin) {
      const uint32_t i = by_first_[begin];
      const PackItem& item = items_[i];
      uint64_t best_slack = unlimited, place = 0, free_from = 0;
      size_t where = spans_.size();
      for (size_t s = 0; s < spans_.size(); ++s) {
        const uint64_t start = align_to_power_of_two(free_from, item.alignment);
        const uint64_t slack = spans_[s].begin - start - item.size;
        if (start + item.size <= spans_[s].begin && slack < best_slack) {
          best_slack = slack;
          place = start;
          where = s;
        }
        free_from = spans_[s].end;
      }
      if (best_slack == unlimited) place = align_to_power_of_two(free_from, item.alignment);
      spans_.insert(spans_.begin() + static_cast<std::ptrdiff_t>(where),
                    {place, place + item.size, i});
      offsets_[i] = place;
      size = std::max(size, place + item.size);
    }
  }
  if (size >= out.size) return;
  out.size = size;
  out.offsets = offsets_;
}

namespace {

// Finds the gap for one item among the ranges that overlap its lifetime, which are passed in
// ascending order. Free of branches, because which gap fits is unpredictable.
struct GapFinder {
  static constexpr uint64_t no_gap =
      UINT64_MAX / 2; // sizes stay far below: a gap too small wraps to beyond it
  uint64_t size, alignment;
  uint64_t keep; // 0: the first gap that fits; all bits: the tightest one
  uint64_t best = 0, best_slack = no_gap, free_from = 0;

  void pass(uint64_t begin, uint64_t end) {
    const uint64_t start = align_to_power_of_two(free_from, alignment);
    const uint64_t slack = begin - start - size;
    const bool better = slack < best_slack;
    best = select(better, start, best);
    best_slack = select(better, slack & keep, best_slack);
    free_from = std::max(free_from, end);
  }
  uint64_t place() const {
    return select(best_slack < no_gap, best, align_to_power_of_two(free_from, alignment));
  }
};

constexpr uint32_t chunk = numbers_at_once; // placed items that are tested together

// Returns one bit for each position of a block of the schedule at which the item is live, and
// began_before if its lifetime began in an earlier block.
uint32_t positions_in(uint32_t block, const PackItem& item) {
  const uint32_t begin = block * block_passes;
  const uint32_t first = std::max(item.first, begin) - begin;
  const uint32_t last = std::min(item.last - begin, block_passes - 1);
  const uint32_t bits = (uint32_t{2} << last) - (uint32_t{1} << first);
  return bits | (item.first < begin ? began_before : 0);
}

} // namespace

void Packer::Block::clear() {
  std::fill_n(when.begin(), count, 0u);
  count = 0;
}

void Packer::Block::insert(const Range& range, uint32_t positions) {
  if (count + 1 > ranges.size()) {
    ranges.resize(ranges.size() + chunk);
    when.resize(ranges.size(), 0);
  }
  size_t at = count++;
  for (; at > 0 && ranges[at - 1].begin > range.begin; --at) {
    ranges[at] = ranges[at - 1];
    when[at] = when[at - 1];
  }
  ranges[at] = range;
  when[at] = positions;
}

// Appends the ranges that are live in `positions` of the block to `to`, which has room for all; if
// `began`, only ranges that begin in the block. Returns their number.
size_t Packer::gather(const Block& block, uint32_t positions, bool only_begun, Range* to) {
  steps_ += block.count;
  size_t count = 0;
  for (size_t from = 0; from < block.count; from += chunk) {
    uint32_t bits = any_common_bits(block.when.data() + from, positions & ~began_before);
    if (only_begun) bits &= ~any_common_bits(block.when.data() + from, began_before);
    for (; bits != 0; bits &= bits - 1)
      to[count++] = block.ranges[from + static_cast<size_t>(std::countr_zero(bits))];
  }
  return count;
}

// Returns the best offset for `item` among the ranges placed in its blocks.
uint64_t Packer::find_place(const PackItem& item, uint32_t first, uint32_t last, Fit fit) {
  constexpr Range end_of_list = {unlimited, unlimited};
  GapFinder gaps{item.size, item.alignment, fit == Fit::first ? 0 : ~uint64_t{0}};
  if (first == last) {
    const Block& block = blocks_[first];
    const uint32_t positions = positions_in(first, item);
    steps_ += block.count;
    for (size_t from = 0; from < block.count; from += chunk)
      for (uint32_t bits = any_common_bits(block.when.data() + from, positions); bits != 0;
           bits &= bits - 1) {
        const Range& other = block.ranges[from + static_cast<size_t>(std::countr_zero(bits))];
        gaps.pass(other.begin, other.end);
      }
    return gaps.place();
  }
  Range* a = gathered_.data();
  const size_t count_a = gather(blocks_[first], positions_in(first, item), false, a);
  a[count_a] = end_of_list;
  Range* b = a + count_a + 1; // each range in the block where it begins
  size_t count_b = 0;
  for (uint32_t block = first + 1; block <= last; ++block)
    count_b += gather(blocks_[block], positions_in(block, item), true, b + count_b);
  if (last - first > 1)
    std::sort(b, b + count_b, [](const Range& x, const Range& y) { return x.begin < y.begin; });
  b[count_b] = end_of_list;
  for (size_t left = count_a + count_b; left > 0; --left) {
    const bool from_b = b->begin < a->begin;
    gaps.pass(select(from_b, b->begin, a->begin), select(from_b, b->end, a->end));
    b += static_cast<size_t>(from_b);
    a += size_t{1} - static_cast<size_t>(from_b);
  }
  return gaps.place();
}

// Places items one by one in the given order and fills offsets_. Returns the size, or `limit` as
// soon as it is reached.
uint64_t Packer::place_in_order(std::span<const uint32_t> order, Fit fit, uint64_t limit) {
  const size_t blocks = change_.size() / block_passes + 1;
  for (size_t b = 0; b < blocks; ++b)
    blocks_[b].clear();
  uint64_t size = 0;
  for (const uint32_t i : order) {
    const PackItem& item = items_[i];
    const uint32_t first = item.first / block_passes, last = item.last / block_passes;
    const uint64_t place = find_place(item, first, last, fit);
    size = std::max(size, place + item.size);
    if (size >= limit) return limit;
    offsets_[i] = place;
    for (uint32_t b = first; b <= last; ++b)
      blocks_[b].insert({place, place + item.size}, positions_in(b, item));
  }
  return size;
}

// Keeps the result if it is the smallest so far.
bool Packer::try_order(std::span<const uint32_t> order, Fit fit, Packing& out) {
  const uint64_t size = place_in_order(order, fit, out.size);
  if (size >= out.size) return false;
  out.size = size;
  out.offsets = offsets_;
  return true;
}

// Sorts by descending size, stably. Graphs have few different sizes, so a counting sort suffices.
void Packer::sort_by_size(const std::vector<uint32_t>& given, std::vector<uint32_t>& sorted) {
  constexpr uint32_t few_sizes = 32;
  sizes_.clear();
  size_class_.resize(items_.size());
  for (const uint32_t i : given) {
    const uint64_t size = items_[i].size;
    const auto known = static_cast<uint32_t>(sizes_.size());
    uint32_t same = known;
    for (uint32_t k = 0; k < known; ++k) // no early exit: the position is unpredictable
      same = select(sizes_[k] == size, k, same);
    if (same == known) {
      if (known == few_sizes) break;
      sizes_.push_back(size);
    }
    size_class_[i] = same;
  }
  const auto count = static_cast<uint32_t>(sizes_.size());
  if (count == few_sizes) {
    sorted = given;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](uint32_t a, uint32_t b) { return items_[a].size > items_[b].size; });
    return;
  }
  std::array<uint32_t, few_sizes> rank{}; // by class: how many sizes are larger
  for (uint32_t k = 0; k < count; ++k)
    for (uint32_t other = 0; other < count; ++other)
      rank[k] += static_cast<uint32_t>(sizes_[other] > sizes_[k]);
  std::array<uint32_t, few_sizes + 1> starts{}; // by rank
  for (const uint32_t i : given)
    ++starts[rank[size_class_[i]] + 1];
  for (uint32_t k = 0; k < count; ++k)
    starts[k + 1] += starts[k];
  sorted.resize(given.size());
  for (const uint32_t i : given)
    sorted[starts[rank[size_class_[i]]]++] = i;
}

void Packer::try_orders(Packing& out) {
  const auto duration = [&](uint32_t i) { return uint64_t{items_[i].last} - items_[i].first + 1; };
  const auto keep = [&](Fit fit) {
    if (!try_order(order_, fit, out)) return;
    best_order_ = order_;
    best_fit_ = fit;
  };
  const auto try_sorted = [&](auto larger) {
    order_ = by_size_;
    std::stable_sort(order_.begin(), order_.end(),
                     [&](uint32_t a, uint32_t b) { return larger(a) > larger(b); });
    for (const Fit fit : {Fit::first, Fit::tightest})
      if (out.size > out.lower_bound) keep(fit);
  };
  best_order_ = by_size_;
  try_sorted([&](uint32_t i) { return items_[i].size; });
  try_sorted([&](uint32_t i) { return items_[i].size * duration(i); });
  try_sorted([&](uint32_t i) { return duration(i); });
  try_sorted([&](uint32_t i) { return std::bit_width(duration(i)); });
  try_sorted([&](uint32_t i) { return ~uint64_t{items_[i].first}; });
}

// Local search: moves an item, preferably one at the top of the heap, to another turn, and keeps
// orders that are not worse. Restarts from a perturbed best order after `patience` moves without a
// gain.
void Packer::search(uint64_t steps, Packing& out) {
  constexpr uint32_t max_idle_moves = 200; // moves
  SplitMix64 random{items_.size()};
  const uint64_t end = steps_ + steps;
  std::vector<uint32_t>& current = order_;
  current = best_order_;
  uint64_t current_size = place_in_order(current, best_fit_, unlimited);
  Fit fit = best_fit_;
  uint32_t idle = 0;
  std::vector<uint32_t> high;
  while (out.size > out.lower_bound && steps_ < end) {
    high.clear();
    for (uint32_t at = 0; at < current.size(); ++at)
      if (offsets_[current[at]] + items_[current[at]].size >= current_size) high.push_back(at);
    size_t from = high.empty() || random.below(4) == 0 ? random.below(current.size())
                                                       : high[random.below(high.size())];
    size_t to = random.below(current.size());
    if (from < to && random.below(4) != 0) std::swap(from, to);
    const auto move = [&](size_t source, size_t target) {
      const auto begin = current.begin();
      const auto s = static_cast<std::ptrdiff_t>(source), t = static_cast<std::ptrdiff_t>(target);
      if (source > target)
        std::rotate(begin + t, begin + s, begin + s + 1);
      else
        std::rotate(begin + s, begin + s + 1, begin + t + 1);
    };
    move(from, to);
    const uint64_t size = place_in_order(current, fit, current_size + 1);
    if (size > current_size) {
      move(to, from);
      place_in_order(current, fit, unlimited); // restores the offsets
      ++idle;
    } else {
      idle = size < current_size ? 0 : idle + 1;
      current_size = size;
      if (size < out.size) {
        out.size = size;
        out.offsets = offsets_;
        best_order_ = current;
        best_fit_ = fit;
      }
    }
    if (idle < max_idle_moves) continue;
    idle = 0;
    current = best_order_;
    fit = random.below(2) == 0 ? Fit::first : Fit::tightest;
    for (size_t swaps = 1 + current.size() / 8; swaps > 0; --swaps)
      std::swap(current[random.below(current.size())], current[random.below(current.size())]);
    current_size = place_in_order(current, fit, unlimited);
  }
}

// Tries other orders if the first placement is far from the bound: among equal sizes the last end
// first, then products of powers of size and time.
void Packer::try_again(Packing& out) {
  // Worth a try if more than 1 / waste_divisor of the lower bound is wasted. In large graphs fewer
  // orders help, and a smaller waste is worth them.
  constexpr size_t many_items = 4096;
  const bool large = items_.size() >= many_items;
  const uint64_t waste_divisor = large ? 16 : 11;
  const auto worth_a_try = [&] {
    return out.size - out.lower_bound > out.lower_bound / waste_divisor;
  };
  if (!worth_a_try()) return;
  if (!large) {
    const auto count = static_cast<uint32_t>(items_.size());
    const auto positions = static_cast<uint32_t>(change_.size());
    counting_sort(count, positions, last_at_, by_last_, [&](uint32_t i) { return items_[i].last; });
    std::reverse(by_last_.begin(), by_last_.end());
    sort_by_size(by_last_, order_);
    try_order(order_, Fit::tightest, out);
  }
  // The powers with the best results on randomly generated fans and graphs of 100 to 10,000 passes
  // (`dermis bench compile`).
  struct Powers {
    uint32_t size, time;
  };
  constexpr std::array<Powers, 3> powers = {{{2, 1}, {1, 2}, {2, 3}}};
  for (const Powers power : std::span(powers).subspan(large ? 1 : 0)) {
    if (!worth_a_try()) return;
    by_weight(power.size, power.time, order_);
    try_order(order_, Fit::tightest, out);
  }
}

// Sorts stably by descending size^a * time^b, starting from by_size_.
void Packer::by_weight(uint32_t a, uint32_t b, std::vector<uint32_t>& sorted) {
  // Sizes in pages of 64 KiB, times in passes. Products of doubles are the same with every
  // compiler.
  constexpr uint32_t page_bits = 16;
  weights_.clear();
  for (const PackItem& item : items_) {
    const double size = static_cast<double>((item.size >> page_bits) + 1);
    const double time = static_cast<double>(uint64_t{item.last} - item.first + 1);
    double weight = 1.0;
    for (uint32_t i = 0; i < a; ++i)
      weight *= size;
    for (uint32_t i = 0; i < b; ++i)
      weight *= time;
    weights_.push_back(weight);
  }
  sorted = by_size_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [&](uint32_t x, uint32_t y) { return weights_[x] > weights_[y]; });
}

// Places items of equal lifetimes one after another, the most aligned first. For many items, where
// all orders would take minutes.
void Packer::stack(Packing& out) {
  order_ = by_size_;
  std::stable_sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) {
    return items_[a].alignment > items_[b].alignment;
  });
  out.offsets.resize(items_.size());
  out.size = 0;
  for (const uint32_t i : order_) {
    out.offsets[i] = align_to_power_of_two(out.size, items_[i].alignment);
    out.size = out.offsets[i] + items_[i].size;
  }
}

void Packer::pack(std::span<const PackItem> items, PackingLevel level, Packing& out) {
  items_ = items;
  steps_ = 0;
  out.offsets.clear();
  out.size = 0;
  find_bound(out);
  if (items.empty()) return;
  if (blocks_.size() < change_.size() / block_passes + 1)
    blocks_.resize(change_.size() / block_passes + 1);
  offsets_.resize(items.size());
  if (gathered_.size() < items.size() + 3)
    gathered_.resize(items.size() + 3); // and the ends of two lists
  counting_sort(static_cast<uint32_t>(items.size()), static_cast<uint32_t>(change_.size()),
                first_at_, by_first_, [&](uint32_t i) { return items_[i].first; });
  sort_by_size(by_first_, by_size_);
  constexpr size_t many_histories = 1024;
  const bool all_overlap = std::all_of(items.begin(), items.end(), [&](const PackItem& item) {
    return item.first == items.front().first && item.last == items.front().last;
  });
  if (items.size() > many_histories && all_overlap) return stack(out);
  out.size = unlimited;
  try_order(by_size_, Fit::tightest, out);
  if (out.size == out.lower_bound) return;
  try_again(out);
  if (level == PackingLevel::fast) return;
  place_by_time(out);
  if (out.size == out.lower_bound) return;
  const uint64_t budget = level == PackingLevel::optimize
                              ? optimize_steps
                              : std::min(tight_steps_per_item * items.size(), max_tight_steps);
  best_fit_ = Fit::tightest;
  try_orders(out);
  if (out.size > out.lower_bound && steps_ < budget) search(budget - steps_, out);
}

Packing pack_items(const std::vector<PackItem>& items, PackingLevel level) {
  Packing packing;
  Packer().pack(items, level, packing);
  return packing;
}

} // namespace dermis
