// Dynamic storage allocation: intervals in time get places in one range of bytes.

#include "framegraph/compile/pack.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace dermis {
namespace {

// Comparisons of two items the searches may make; one takes about a nanosecond.
constexpr uint64_t tight_steps_per_item = 6'000;
constexpr uint64_t optimize_steps = 1'000'000'000;
constexpr uint32_t block_passes = 16; // positions that share one list of what is alive in them
constexpr uint64_t unlimited = UINT64_MAX;

uint64_t align_up(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) & ~(alignment - 1);
}

// SplitMix64 (Steele, Lea, Flood 2014): the same numbers from every standard library.
struct Random {
  uint64_t state;
  size_t below(size_t limit) {
    state += 0x9e3779b97f4a7c15ull;
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<size_t>((z ^ (z >> 31)) % limit);
  }
};

// Indices of `count` items in the order of key(i), equal ones in their own order.
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
  int64_t alive = 0, most = 0;
  for (const int64_t change : change_)
    most = std::max(most, alive += change);
  out.lower_bound = static_cast<uint64_t>(most);
}

// In the order of time: what is over makes room, what begins takes the tightest gap.
void Packer::place_by_time(Packing& out) {
  const auto count = static_cast<uint32_t>(items_.size());
  const auto positions = static_cast<uint32_t>(change_.size());
  counting_sort(count, positions, first_at_, by_first_, [&](uint32_t i) { return items_[i].first; });
  counting_sort(count, positions, last_at_, by_last_, [&](uint32_t i) { return items_[i].last; });
  spans_.clear();
  uint64_t size = 0;
  uint32_t over = 0;
  for (uint32_t begin = 0; begin < count;) {
    const uint32_t now = items_[by_first_[begin]].first;
    uint32_t end = begin;
    while (end < count && items_[by_first_[end]].first == now)
      ++end;
    for (uint32_t i = begin + 1; i < end; ++i) // few begin together: the largest of them first
      for (uint32_t at = i; at > begin && items_[by_first_[at]].size > items_[by_first_[at - 1]].size; --at)
        std::swap(by_first_[at], by_first_[at - 1]);
    for (; over < count && items_[by_last_[over]].last < now; ++over) {
      const uint32_t gone = by_last_[over];
      const auto at = std::lower_bound(spans_.begin(), spans_.end(), offsets_[gone],
                                       [](const Span& span, uint64_t offset) { return span.begin < offset; });
      spans_.erase(at);
    }
    for (; begin < end; ++begin) {
      const uint32_t i = by_first_[begin];
      const PackItem& item = items_[i];
      uint64_t best_slack = unlimited, place = 0, free_from = 0;
      size_t where = spans_.size();
      for (size_t s = 0; s < spans_.size(); ++s) {
        const uint64_t start = align_up(free_from, item.alignment);
        const uint64_t slack = spans_[s].begin - start - item.size;
        if (start + item.size <= spans_[s].begin && slack < best_slack) {
          best_slack = slack;
          place = start;
          where = s;
        }
        free_from = spans_[s].end;
      }
      if (best_slack == unlimited) place = align_up(free_from, item.alignment);
      spans_.insert(spans_.begin() + static_cast<std::ptrdiff_t>(where), {place, place + item.size, i});
      offsets_[i] = place;
      size = std::max(size, place + item.size);
    }
  }
  if (size >= out.size) return;
  out.size = size;
  out.offsets = offsets_;
}

// The next gap for `item` below what is placed: called for all that are alive with it, by rising begin.
struct GapFinder {
  uint64_t size, alignment;
  bool first_only;
  uint64_t best = unlimited, best_slack = unlimited, free_from = 0;

  // False: no better gap can come.
  bool pass(uint64_t begin, uint64_t end) {
    if (begin > free_from) {
      const uint64_t start = align_up(free_from, alignment);
      if (start + size <= begin && begin - start - size < best_slack) {
        best = start;
        best_slack = begin - start - size;
        if (first_only || best_slack == 0) return false;
      }
    }
    free_from = std::max(free_from, end);
    return true;
  }
  uint64_t place() const { return best != unlimited ? best : align_up(free_from, alignment); }
};

// Calls visit for everything placed in blocks [first, last] that is alive with `item`, by rising begin, until
// it returns false.
template <class Visit>
void Packer::for_each_alive(const PackItem& item, uint32_t first, uint32_t last, Visit visit) {
  const auto alive = [&](const Placed& other) {
    return other.first <= item.last && item.first <= other.last;
  };
  if (last - first < 2) { // nearly always: one block, or two to merge
    const std::vector<Placed>& a = blocks_[first];
    const std::vector<Placed>& b = blocks_[last];
    size_t at_a = 0, at_b = first == last ? b.size() : 0;
    steps_ += a.size() + b.size() - at_b;
    while (at_a < a.size() || at_b < b.size()) {
      const bool from_a = at_b == b.size() || (at_a < a.size() && a[at_a].begin <= b[at_b].begin);
      const Placed& other = from_a ? a[at_a++] : b[at_b++];
      if (alive(other) && !visit(other.begin, other.end)) return;
    }
    return;
  }
  gathered_.clear();
  for (uint32_t block = first; block <= last; ++block) {
    steps_ += blocks_[block].size();
    for (const Placed& other : blocks_[block])
      if (alive(other) && std::max(other.first, item.first) / block_passes <= block &&
          (block == first || other.first / block_passes == block)) // where it is met first
        gathered_.push_back(other);
  }
  std::sort(gathered_.begin(), gathered_.end(),
            [](const Placed& a, const Placed& b) { return a.begin < b.begin; });
  for (const Placed& other : gathered_)
    if (!visit(other.begin, other.end)) return;
}

// Places items one by one among all those placed before that are alive with them; fills offsets_. Returns the
// size, or `limit` as soon as it is reached.
uint64_t Packer::place_in_order(std::span<const uint32_t> order, Fit fit, uint64_t limit) {
  for (std::vector<Placed>& block : blocks_)
    block.clear();
  uint64_t size = 0;
  for (const uint32_t i : order) {
    const PackItem& item = items_[i];
    const uint32_t first = item.first / block_passes, last = item.last / block_passes;
    GapFinder gaps{item.size, item.alignment, fit == Fit::first};
    for_each_alive(item, first, last, [&](uint64_t begin, uint64_t end) { return gaps.pass(begin, end); });
    const uint64_t place = gaps.place();
    size = std::max(size, place + item.size);
    if (size >= limit) return limit;
    offsets_[i] = place;
    for (uint32_t b = first; b <= last; ++b) {
      std::vector<Placed>& block = blocks_[b];
      size_t at = block.size();
      while (at > 0 && block[at - 1].begin > place)
        --at;
      block.insert(block.begin() + static_cast<std::ptrdiff_t>(at),
                   {place, place + item.size, item.first, item.last});
    }
  }
  return size;
}

// Keeps the result if it is smaller than the best so far.
bool Packer::try_order(std::span<const uint32_t> order, Fit fit, Packing& out) {
  const uint64_t size = place_in_order(order, fit, out.size);
  if (size >= out.size) return false;
  out.size = size;
  out.offsets = offsets_;
  return true;
}

// Largest first, then by first use. Graphs have few different sizes: those are counted instead of sorted.
void Packer::sort_by_size() {
  constexpr size_t few_sizes = 32;
  const auto count = static_cast<uint32_t>(items_.size());
  counting_sort(count, static_cast<uint32_t>(change_.size()), first_at_, by_first_,
                [&](uint32_t i) { return items_[i].first; });
  sizes_.clear();
  for (uint32_t i = 0; i < count && sizes_.size() <= few_sizes; ++i)
    if (std::find(sizes_.begin(), sizes_.end(), items_[i].size) == sizes_.end())
      sizes_.push_back(items_[i].size);
  if (sizes_.size() > few_sizes) {
    by_size_ = by_first_;
    std::stable_sort(by_size_.begin(), by_size_.end(),
                     [&](uint32_t a, uint32_t b) { return items_[a].size > items_[b].size; });
    return;
  }
  std::sort(sizes_.begin(), sizes_.end(), std::greater<>());
  by_size_.clear();
  for (const uint64_t size : sizes_)
    for (const uint32_t i : by_first_)
      if (items_[i].size == size) by_size_.push_back(i);
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
  try_sorted([&](uint32_t i) { return ~uint64_t{items_[i].first}; });
}

// Moves an item that reaches highest, or any, to an earlier turn; keeps what is not worse, and starts again
// from the best when that leads nowhere.
void Packer::search(uint64_t steps, Packing& out) {
  constexpr uint32_t patience = 200; // moves without a smaller result
  Random random{items_.size()};
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
    size_t from =
        high.empty() || random.below(4) == 0 ? random.below(current.size()) : high[random.below(high.size())];
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
      place_in_order(current, fit, unlimited); // offsets of what is kept
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
    if (idle < patience) continue;
    idle = 0;
    current = best_order_;
    fit = random.below(2) == 0 ? Fit::first : Fit::tightest;
    for (size_t kick = 1 + current.size() / 8; kick > 0; --kick)
      std::swap(current[random.below(current.size())], current[random.below(current.size())]);
    current_size = place_in_order(current, fit, unlimited);
  }
}

void Packer::pack(std::span<const PackItem> items, PackingLevel level, Packing& out) {
  items_ = items;
  steps_ = 0;
  out.offsets.clear();
  out.size = 0;
  find_bound(out);
  if (items.empty()) return;
  if (blocks_.size() < change_.size() / block_passes + 1) blocks_.resize(change_.size() / block_passes + 1);
  offsets_.resize(items.size());
  sort_by_size();
  out.size = unlimited;
  try_order(by_size_, Fit::tightest, out);
  if (out.size == out.lower_bound) return;
  if (level == PackingLevel::fast) return;
  place_by_time(out);
  if (out.size == out.lower_bound) return;
  const uint64_t budget =
      level == PackingLevel::optimize ? optimize_steps : tight_steps_per_item * items.size();
  if (level == PackingLevel::tight && items.size() * items.size() > budget) return;
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
