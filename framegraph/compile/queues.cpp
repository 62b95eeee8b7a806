// Assigns each live pass to the main queue or to the async queue.

#include "framegraph/compile/phases.hpp"

namespace dermis {
namespace {

// Returns a resource that ties a pass to the main queue, or an invalid id. The host passes its
// resources to one queue only; histories would change queues between frames; divided images are not
// supported.
ResourceId tie_to_main(const Sizes& sizes, const Subresources& subresources,
                       std::span<const Use> uses) {
  for (const Use& use : uses) {
    if (use.bind_error != Use::BindError::none) continue;
    const ResourceInfo& info = sizes.info[use.resource.value];
    if (info.host_owned || info.history || subresources.divided(use.resource)) return use.resource;
  }
  return {};
}

} // namespace

const QueueAssignment& assign_queues(const CompileInput& in, const Sizes& sizes,
                                     const Subresources& subresources, const Versions& versions,
                                     const LiveSet& live, Report& report, QueueScratch& scratch) {
  const Graph& graph = *in.graph;
  QueueAssignment& queues = scratch.result;
  queues.by_pass.clear();
  if (in.single_queue) return queues;
  queues.by_pass.assign(graph.passes.size(), Queue::main);
  for (uint32_t pass = 0; pass < graph.passes.size(); ++pass) {
    if (!live.passes[pass] || !graph.passes[pass].async) continue;
    const ResourceId tie = tie_to_main(sizes, subresources, versions.uses_of(pass));
    if (!tie.valid()) queues.by_pass[pass] = Queue::async;
    report.record_reason(
        Reason::About::pass, pass,
        tie.valid() ? Reason::ReasonKind::not_async : Reason::ReasonKind::async_queue, tie.value);
  }
  return queues;
}

} // namespace dermis
