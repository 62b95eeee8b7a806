// Graphs in which some pass needs one that stands behind it in the file: Kahn's algorithm, and which cycle
// there is when it ends early.

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <queue>

namespace dermis {
namespace {

struct Edge { // `before` must run before `after`
  enum class ReasonKind : uint8_t { reads, overwritten, overwrites, ordered };
  PassId before, after;
  ReasonKind why = ReasonKind::reads;
  ResourceId resource;
  uint32_t ordering = 0; // into the later pass's `after`
};

std::vector<Edge> dependencies(const CompileContext& c, const std::vector<uint8_t>& wanted,
                               bool with_readers) {
  std::vector<Edge> edges;
  const auto add = [&](const Edge& edge) {
    if (!edge.before.valid() || !edge.after.valid() || edge.before == edge.after) return;
    if (wanted[edge.before.value] && wanted[edge.after.value]) edges.push_back(edge);
  };
  std::vector<PassId> overwriter(c.values.size()); // by value: the pass that writes over it
  for (const Value& value : c.values)
    if (value.previous != no_value) overwriter[value.previous] = value.producer;
  for (const Use& use : c.uses) {
    if (use.bind_error != Use::BindError::none) continue;
    if (use.read_value != no_value) {
      const Value& read = c.values[use.read_value];
      add({read.producer, use.pass, Edge::ReasonKind::reads, read.resource});
      if (with_readers)
        add({use.pass, overwriter[use.read_value], Edge::ReasonKind::overwritten, read.resource});
    }
    if (use.write_value != no_value && c.values[use.write_value].previous != no_value) {
      const Value& previous = c.values[c.values[use.write_value].previous];
      add({previous.producer, use.pass, Edge::ReasonKind::overwrites, previous.resource});
    }
  }
  for (uint32_t i = 0; i < c.graph->passes.size(); ++i)
    for (uint32_t k = 0; k < c.graph->passes[i].after.size(); ++k)
      add({c.graph->passes[i].after[k].after, PassId{i}, Edge::ReasonKind::ordered, {}, k});
  return edges;
}

std::string explain(const CompileContext& c, const Edge& edge) {
  const std::string &before = c.name(edge.before), &after = c.name(edge.after);
  switch (edge.why) {
  case Edge::ReasonKind::reads:
    return fmt::format("'{}' reads '{}' from '{}'", after, c.name(edge.resource), before);
  case Edge::ReasonKind::overwritten:
    return fmt::format("'{}' writes over '{}', which '{}' still reads", after, c.name(edge.resource), before);
  case Edge::ReasonKind::overwrites:
    return fmt::format("'{}' writes over '{}' from '{}'", after, c.name(edge.resource), before);
  case Edge::ReasonKind::ordered:
    break;
  }
  return fmt::format("'{}' is to run after '{}': {}", after, before,
                     c.graph->passes[edge.after.value].after[edge.ordering].reason);
}

// Kahn's algorithm, the smallest pass first. What is missing from the result lies on or behind a cycle.
std::vector<PassId> sorted(const std::vector<uint8_t>& wanted, const std::vector<Edge>& edges) {
  std::vector<uint32_t> waits(wanted.size(), 0);
  std::vector<std::vector<PassId>> followers(wanted.size());
  for (const Edge& edge : edges) {
    ++waits[edge.after.value];
    followers[edge.before.value].push_back(edge.after);
  }
  std::priority_queue<uint32_t, std::vector<uint32_t>, std::greater<>> ready;
  for (uint32_t i = 0; i < wanted.size(); ++i)
    if (wanted[i] && waits[i] == 0) ready.push(i);
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

// Walk against the edges among the passes that could not be sorted: each has one that waits too, so the walk
// returns to a pass it has been at, and that part of it is a cycle.
void report_cycle(CompileContext& c, std::vector<uint8_t> stuck, const std::vector<PassId>& done,
                  const std::vector<Edge>& edges) {
  for (const PassId pass : done)
    stuck[pass.value] = 0;
  std::vector<uint32_t> incoming(stuck.size(), no_value); // by pass: one edge from a stuck pass
  for (uint32_t e = 0; e < edges.size(); ++e)
    if (stuck[edges[e].before.value] && stuck[edges[e].after.value] &&
        incoming[edges[e].after.value] == no_value)
      incoming[edges[e].after.value] = e;
  const auto first = static_cast<uint32_t>(std::find(stuck.begin(), stuck.end(), 1) - stuck.begin());
  std::vector<uint8_t> seen(stuck.size(), 0);
  uint32_t at = first;
  while (!seen[at]) {
    seen[at] = 1;
    at = edges[incoming[at]].before.value;
  }
  std::vector<const Edge*> cycle;
  for (uint32_t start = at; cycle.empty() || at != start; at = cycle.back()->before.value)
    cycle.push_back(&edges[incoming[at]]);
  std::reverse(cycle.begin(), cycle.end());
  // Start with the pass that stands first in the file, so that the message does not depend on where the walk
  // began.
  std::rotate(cycle.begin(),
              std::min_element(cycle.begin(), cycle.end(),
                               [](const Edge* a, const Edge* b) { return a->before < b->before; }),
              cycle.end());
  std::string names;
  for (const Edge* edge : cycle)
    names += fmt::format("'{}' -> ", c.name(edge->before));
  auto& diagnostic = c.diagnostics->add(
      DiagnosticId::pass_cycle, c.graph->passes[cycle.front()->before.value].where,
      fmt::format("passes wait for each other: {}'{}'", names, c.name(cycle.front()->before)));
  for (const Edge* edge : cycle)
    diagnostic.related.emplace_back(c.graph->passes[edge->after.value].where, explain(c, *edge));
}

} // namespace

void sort_backward_graph(CompileContext& c) {
  // A cycle is a mistake even among passes that nothing needs today.
  const auto everywhere = dependencies(c, c.on, false);
  const auto all = sorted(c.on, everywhere);
  const auto count = [](const std::vector<uint8_t>& flags) {
    return static_cast<size_t>(std::count(flags.begin(), flags.end(), 1));
  };
  if (all.size() != count(c.on)) return report_cycle(c, c.on, all, everywhere);
  const auto among_live = dependencies(c, c.live, true);
  c.order = sorted(c.live, among_live);
  if (c.order.size() != count(c.live)) report_cycle(c, c.live, c.order, among_live);
}

} // namespace dermis
