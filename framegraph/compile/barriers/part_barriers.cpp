// Barriers of one batch that differ in the parts of an image alone become one.

#include "framegraph/compile/barriers/steps.hpp"

#include <algorithm>
#include <set>
#include <tuple>

namespace dermis {
namespace {

bool unite(SubresourceRange& a, const SubresourceRange& b) {
  if (a.first_layer == b.first_layer && a.layers == b.layers && a.first_mip + a.mips == b.first_mip) {
    a.mips = static_cast<uint16_t>(a.mips + b.mips);
    return true;
  }
  if (a.first_mip == b.first_mip && a.mips == b.mips && a.first_layer + a.layers == b.first_layer) {
    a.layers = static_cast<uint16_t>(a.layers + b.layers);
    return true;
  }
  return false;
}

bool merge(PlanBarrier& a, const PlanBarrier& b) {
  const auto same = [](const PlanBarrier& one) {
    return std::tuple(one.resource, one.frames_back, one.source_stages, one.destination_stages,
                      one.source_access, one.destination_access, one.old_layout, one.new_layout, one.why,
                      one.from_host, one.to_host, one.transfer);
  };
  return same(a) == same(b) && unite(a.range, b.range);
}

} // namespace

void merge_part_barriers(CompileContext& c) {
  std::vector<uint32_t> kept, place_of(c.drafts.size());
  for (uint32_t i = 0; i < c.drafts.size(); ++i) {
    kept.push_back(i);
    place_of[i] = i;
    while (kept.size() > 1) {
      const uint32_t earlier = kept[kept.size() - 2], later = kept.back();
      if (c.batch_of[earlier] != c.batch_of[later] || !merge(c.drafts[earlier], c.drafts[later])) break;
      place_of[later] = earlier;
      kept.pop_back();
    }
  }
  std::vector<uint32_t> number(c.drafts.size());
  for (uint32_t k = 0; k < kept.size(); ++k) {
    number[kept[k]] = k;
    c.drafts[k] = c.drafts[kept[k]];
    c.batch_of[k] = c.batch_of[kept[k]];
  }
  for (uint32_t i = 0; i < place_of.size(); ++i) // into what it stands in now
    if (place_of[i] != i) number[i] = number[place_of[i]];
  c.drafts.resize(kept.size());
  c.batch_of.resize(kept.size());
  using Key = std::tuple<uint32_t, Reason::ReasonKind, uint32_t, uint32_t, uint32_t>;
  std::set<Key> seen;
  std::vector<Reason>& reasons = c.out->reasons;
  const auto repeated = [&](Reason& reason) {
    reason.index = number[reason.index];
    return !seen.insert({reason.index, reason.why, reason.a, reason.b, reason.c}).second;
  };
  reasons.erase(std::remove_if(reasons.begin() + static_cast<std::ptrdiff_t>(c.reasons_before), reasons.end(),
                               repeated),
                reasons.end());
}

} // namespace dermis
