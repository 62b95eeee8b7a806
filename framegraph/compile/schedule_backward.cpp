// Sorts graphs in which some pass depends on a pass that is located after it in the file, with
// Kahn's algorithm. Reports a cycle if the algorithm ends early.

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <queue>

namespace dermis {
namespace {

struct Edge { // `before` must run before `after`
  // read after write, write after read, write after write, or declared with "after"
  enum class Kind : uint8_t { reads, overwritten, overwrites, ordered };
  PassId before, after;
  Kind kind = Kind::reads;
  ResourceId resource;
  uint32_t ordering = 0; // into the later pass's `after`
};

std::vector<Edge> find_dependencies(const Graph& graph, const Versions& versions,
                                    const std::vector<uint8_t>& included, bool with_readers) {
  std::vector<Edge> edges;
  const auto add = [&](const Edge& edge) {
    if (!edge.before.valid() || !edge.after.valid() || edge.before == edge.after) return;
    if (included[edge.before.value] && included[edge.after.value]) edges.push_back(edge);
  };
  std::vector<PassId> overwriter(versions.list.size()); // by version: pass that overwrites it
  for (const Version& version : versions.list)
    if (version.previous != invalid_index) overwriter[version.previous] = version.producer;
  for (const Use& use : versions.uses) {
    if (use.bind_error != Use::BindError::none) continue;
    if (use.read_version != invalid_index) {
      const Version& read = versions[use.read_version];
      add({read.producer, use.pass, Edge::Kind::reads, read.resource});
      if (with_readers)
        add({use.pass, overwriter[use.read_version], Edge::Kind::overwritten, read.resource});
    }
    if (use.write_version != invalid_index &&
        versions[use.write_version].previous != invalid_index) {
      const Version& previous = versions[versions[use.write_version].previous];
      add({previous.producer, use.pass, Edge::Kind::overwrites, previous.resource});
    }
  }
  for (uint32_t i = 0; i < graph.passes.size(); ++i)
    for (uint32_t k = 0; k < graph.passes[i].after.size(); ++k)
      add({graph.passes[i].after[k].after, PassId{i}, Edge::Kind::ordered, {}, k});
  return edges;
}

// Returns why the edge exists, as a clause of the message on a cycle.
std::string explain(const Graph& graph, const Edge& edge) {
  const std::string &before = name_of(graph, edge.before), &after = name_of(graph, edge.after);
  switch (edge.kind) {
  case Edge::Kind::reads:
    return fmt::format("'{}' reads '{}' from '{}'", after, name_of(graph, edge.resource), before);
  case Edge::Kind::overwritten:
    return fmt::format("'{}' overwrites '{}', which '{}' reads", after,
                       name_of(graph, edge.resource), before);
  case Edge::Kind::overwrites:
    return fmt::format("'{}' overwrites the '{}' that '{}' writes", after,
                       name_of(graph, edge.resource), before);
  case Edge::Kind::ordered:
    break;
  }
  return fmt::format("'{}' must run after '{}': {}", after, before,
                     graph.passes[edge.after.value].after[edge.ordering].reason);
}

// Kahn's algorithm, the smallest pass first. Passes on a cycle, or that depend on one, are missing
// from the result.
std::vector<PassId> sort_topologically(const std::vector<uint8_t>& included,
                                       const std::vector<Edge>& edges) {
  std::vector<uint32_t> waits(included.size(), 0);
  std::vector<std::vector<PassId>> followers(included.size());
  for (const Edge& edge : edges) {
    ++waits[edge.after.value];
    followers[edge.before.value].push_back(edge.after);
  }
  std::priority_queue<uint32_t, std::vector<uint32_t>, std::greater<>> ready;
  for (uint32_t i = 0; i < included.size(); ++i)
    if (included[i] && waits[i] == 0) ready.push(i);
  std::vector<PassId> result;
  while (!ready.empty()) {
    const uint32_t pass = ready.top();
    ready.pop();
    result.push_back(PassId{pass});
    for (const PassId next : followers[pass])
      if (--waits[next.value] == 0) ready.push(next.value);
  }
  return result;
}

// Follows edges backwards among the passes that could not be sorted. Each of them depends on
// another one, so the path returns to a visited pass, and that section of the path is a cycle.
void report_cycle(const Graph& graph, std::vector<uint8_t> unsorted,
                  const std::vector<PassId>& done, const std::vector<Edge>& edges, Report& report) {
  for (const PassId pass : done)
    unsorted[pass.value] = 0;
  std::vector<uint32_t> incoming(unsorted.size(),
                                 invalid_index); // by pass: one edge from an unsorted pass
  for (uint32_t e = 0; e < edges.size(); ++e)
    if (unsorted[edges[e].before.value] && unsorted[edges[e].after.value] &&
        incoming[edges[e].after.value] == invalid_index)
      incoming[edges[e].after.value] = e;
  const auto first =
      static_cast<uint32_t>(std::find(unsorted.begin(), unsorted.end(), 1) - unsorted.begin());
  std::vector<uint8_t> seen(unsorted.size(), 0);
  uint32_t at = first;
  while (!seen[at]) {
    seen[at] = 1;
    at = edges[incoming[at]].before.value;
  }
  std::vector<const Edge*> cycle;
  for (uint32_t start = at; cycle.empty() || at != start; at = cycle.back()->before.value)
    cycle.push_back(&edges[incoming[at]]);
  std::reverse(cycle.begin(), cycle.end());
  // Rotates the cycle to its first pass in file order, so that the message does not depend on where
  // the path began.
  std::rotate(cycle.begin(),
              std::min_element(cycle.begin(), cycle.end(),
                               [](const Edge* a, const Edge* b) { return a->before < b->before; }),
              cycle.end());
  std::string names;
  for (const Edge* edge : cycle)
    names += fmt::format("'{}' -> ", name_of(graph, edge->before));
  auto& diagnostic = report.diagnostics.add(
      DiagnosticId::pass_cycle, graph.passes[cycle.front()->before.value].where,
      fmt::format("dependency cycle between passes: {}'{}'", names,
                  name_of(graph, cycle.front()->before)));
  for (const Edge* edge : cycle)
    diagnostic.related.emplace_back(graph.passes[edge->after.value].where, explain(graph, *edge));
}

} // namespace

std::vector<PassId> sort_backward_graph(const Graph& graph, const Activation& active,
                                        const Versions& versions, const LiveSet& live,
                                        Report& report) {
  const auto sort_among = [&](const std::vector<uint8_t>& included, bool with_readers) {
    const std::vector<Edge> edges = find_dependencies(graph, versions, included, with_readers);
    std::vector<PassId> order = sort_topologically(included, edges);
    const auto count = static_cast<size_t>(std::count(included.begin(), included.end(), 1));
    if (order.size() != count) report_cycle(graph, included, order, edges, report);
    return order;
  };
  // A cycle is an error even among passes that are not live with these settings.
  std::vector<PassId> all = sort_among(active.on, false);
  return report.failed() ? all : sort_among(live.passes, true);
}

} // namespace dermis
