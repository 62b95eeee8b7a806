// Finds the passes that run: passes with side effects, passes that write a bound export, and the
// producers of everything that live passes read.

#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/phases.hpp"

#include <algorithm>
#include <bit>

namespace dermis {
namespace {

struct Culler {
  const Graph& graph;
  const Sizes& sizes;
  const Activation& active;
  const Versions& versions;
  Report& report;
  CullScratch& scratch;
  LiveSet& live = scratch.result;
  std::vector<uint64_t>& unvisited = scratch.unvisited;

  void mark_live(PassId pass, Reason::ReasonKind why, uint32_t a = 0, uint32_t b = 0) {
    if (report.reasons_requested && !live.contains(pass))
      report.record_reason(Reason::About::pass, pass.value, why, a, b);
    unvisited[pass.value / 64] |= uint64_t{!live.contains(pass)} << pass.value % 64;
    live.passes[pass.value] = 1;
  }

  void mark_producer(uint32_t version, Reason::ReasonKind why, uint32_t a, uint32_t b = 0) {
    if (version != invalid_index && versions[version].producer.valid())
      mark_live(versions[version].producer, why, a, b);
  }

  // Same as mark_producer, for the hot loop. Marks `reader`, which is live already, if there is no
  // producer: that avoids a branch.
  void mark_producer_of_read(uint32_t version, PassId reader, uint32_t resource) {
    if (versions.list.empty()) return;
    const PassId producer = versions[select(version != invalid_index, version, 0u)].producer;
    const bool exists = (int{version != invalid_index} & int{producer.valid()}) != 0;
    mark_live(PassId{select(exists, producer.value, reader.value)}, Reason::ReasonKind::read_by,
              reader.value, resource);
  }

  void visit(PassId pass) {
    for (const Use& use : versions.uses_of(pass)) {
      if (use.bind_error != Use::BindError::none) {
        live.failed_uses.push_back(static_cast<uint32_t>(&use - versions.uses.data()));
        continue;
      }
      const uint32_t resource = use.resource.value;
      if (use.frames_back > 0)
        mark_producer(versions.final_version[use.subresource], Reason::ReasonKind::read_later_by,
                      pass.value, resource);
      mark_producer_of_read(use.read_version, pass, resource);
      // A pass that writes in place may keep texels of the version before.
      if (versions.overwrites && use.write_version != invalid_index)
        mark_producer(versions[use.write_version].previous, Reason::ReasonKind::overwritten_by,
                      pass.value, resource);
    }
  }

  // Visits the last pass first: most passes are located after their producers, so one sweep usually
  // suffices.
  void visit_all() {
    for (bool any = true; any;) {
      any = false;
      for (size_t word = unvisited.size(); word-- > 0;) {
        uint64_t below = ~uint64_t{0}; // passes of this word before the one visited last
        while (const uint64_t left = unvisited[word] & below) {
          const auto bit = static_cast<uint32_t>(std::bit_width(left) - 1);
          below = (uint64_t{1} << bit) - 1;
          unvisited[word] &= ~(uint64_t{1} << bit);
          any = true;
          visit(PassId{static_cast<uint32_t>(word * 64 + bit)});
        }
      }
    }
  }

  // Without culling: keeps every pass whose inputs exist, and their producers.
  void keep_runnable() {
    std::vector<uint8_t> lacks_input(live.passes.size(), 0);
    for (const Use& use : versions.uses)
      if (use.bind_error != Use::BindError::none) lacks_input[use.pass.value] = 1;
    for (uint32_t i = 0; i < live.passes.size(); ++i)
      if (active.on[i] && !lacks_input[i]) mark_live(PassId{i}, Reason::ReasonKind::culling_off);
    for (bool again = true; again;) { // until all producers of each live pass are live
      again = false;
      for (const Use& use : versions.uses) {
        if (!live.passes[use.pass.value] || use.read_version == invalid_index) continue;
        const PassId producer = versions[use.read_version].producer;
        if (!producer.valid() || live.passes[producer.value]) continue;
        live.passes[use.pass.value] = 0;
        again = true;
      }
    }
  }

  // Marks the producers of all bound exports.
  void visit_exports() {
    for (uint32_t i = 0; i < graph.resources.size(); ++i)
      if (sizes.info[i].exported && sizes.info[i].bound)
        mark_producer(versions.final_version[i], Reason::ReasonKind::writes_export, i);
  }
};

} // namespace

const LiveSet& cull(const CompileInput& in, const Sizes& sizes, const Activation& active,
                    const Versions& versions, Report& report, CullScratch& scratch) {
  const Graph& graph = *in.graph;
  LiveSet& live = scratch.result;
  const auto passes = static_cast<uint32_t>(graph.passes.size());
  live.passes.assign(passes, 0);
  scratch.unvisited.assign((passes + 63) / 64, 0);
  live.failed_uses.clear();
  Culler culler{graph, sizes, active, versions, report, scratch};
  culler.visit_exports();
  for (uint32_t i = 0; i < passes; ++i)
    if (active.on[i] && active.type(PassId{i}).side_effects)
      culler.mark_live(PassId{i}, Reason::ReasonKind::side_effects);
  culler.visit_all();
  if (!in.cull) culler.keep_runnable();
  for (uint32_t i = 0; i < passes; ++i)
    if (active.on[i] && !live.passes[i])
      report.record_reason(Reason::About::pass, i, Reason::ReasonKind::not_needed);
  return live;
}

} // namespace dermis
