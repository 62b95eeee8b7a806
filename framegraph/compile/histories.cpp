// Finds when a history's oldest frame is read for the last time, and whether this frame's contents
// can overwrite it in place.

#include "framegraph/compile/phases.hpp"

#include <algorithm>

namespace dermis {
namespace {

HistoryLifetime lifetime_of(const Activation& active, const Versions& versions,
                            const Schedule& schedule, ResourceId id, uint32_t frames) {
  HistoryLifetime result;
  result.frames = frames;
  bool reads_only_own_texels = true; // of the pass that accesses this frame's contents first
  for (uint32_t position = 0; position < schedule.order.size(); ++position) {
    const PassId pass = schedule.order[position];
    bool reads_freely = false, accesses = false;
    for (const Use& use : versions.uses_of(pass)) {
      if (use.bind_error != Use::BindError::none || use.resource != id) continue;
      accesses |= use.frames_back == 0;
      if (use.frames_back != frames) continue;
      result.last_read = position;
      reads_freely |= !active.type(pass).ports[use.port].own_texels;
    }
    if (!accesses || result.first_access != invalid_index) continue;
    result.first_access = position;
    reads_only_own_texels = !reads_freely;
  }
  result.oldest_updated = result.last_read == result.first_access && reads_only_own_texels;
  return result;
}

} // namespace

// A history needs no instance beyond the frames that it keeps if the oldest frame is read before
// its memory is written, or if only the writer reads it and each invocation reads only the texels
// that it writes.
const Histories& analyze_histories(const CompileInput& in, const Activation& active,
                                   const Versions& versions, const Usages& usages,
                                   const Schedule& schedule, Report& report,
                                   std::vector<PlanResource>& resources, HistoryScratch& scratch) {
  Histories& histories = scratch.result;
  histories.by_resource.assign(resources.size(), {});
  for (size_t r = 0; r < resources.size(); ++r) {
    PlanResource& resource = resources[r];
    HistoryLifetime& history = histories.by_resource[r];
    history.frames = usages.resources[resource.declared.value].deepest_read;
    if (history.frames == 0 || !in.alias || resource.declared == in.keep_alive) continue;
    history = lifetime_of(active, versions, schedule, resource.declared, history.frames);
    if (history.last_read >= history.first_access && !history.oldest_updated) continue;
    resource.instance_count = history.frames;
    report.record_reason(Reason::About::resource, resource.declared.value,
                         Reason::ReasonKind::overwritten_in_place, history.frames,
                         history.oldest_updated ? 1 : 0);
  }
  return histories;
}

} // namespace dermis
