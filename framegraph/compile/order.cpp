// In which order the passes run: the order of the file wherever the dependencies allow it. Refuses cycles.

#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <queue>

namespace dermis {
namespace {

struct Edge { // `before` must run before `after`
  PassId before, after;
  std::string why;
};

std::vector<Edge> dependencies(const CompileContext& c, const std::vector<uint8_t>& wanted,
                               bool with_readers) {
  std::vector<Edge> edges;
  const auto add = [&](PassId before, PassId after, auto&& why) {
    if (!before.valid() || !after.valid() || before == after || !wanted[before.value] || !wanted[after.value])
      return;
    edges.push_back({before, after, why()});
  };
  std::vector<PassId> overwriter(c.values.size()); // by value: the pass that writes over it
  for (const Value& value : c.values)
    if (value.previous != no_value) overwriter[value.previous] = value.producer;
  for (const Use& use : c.uses) {
    if (use.trouble != Use::Trouble::none) continue;
    if (use.read_value != no_value) {
      const Value& read = c.values[use.read_value];
      add(read.producer, use.pass, [&] {
        return fmt::format("'{}' reads '{}' from '{}'", c.name(use.pass), c.name(read.resource),
                           c.name(read.producer));
      });
      if (with_readers)
        add(use.pass, overwriter[use.read_value], [&] {
          return fmt::format("'{}' writes over '{}', which '{}' still reads",
                             c.name(overwriter[use.read_value]), c.name(read.resource), c.name(use.pass));
        });
    }
    if (use.write_value != no_value && c.values[use.write_value].previous != no_value) {
      const Value& previous = c.values[c.values[use.write_value].previous];
      add(previous.producer, use.pass, [&] {
        return fmt::format("'{}' writes over '{}' from '{}'", c.name(use.pass), c.name(previous.resource),
                           c.name(previous.producer));
      });
    }
  }
  for (uint32_t i = 0; i < c.graph.passes.size(); ++i)
    for (const Ordering& ordering : c.graph.passes[i].after)
      add(ordering.after, PassId{i}, [&] {
        return fmt::format("'{}' is to run after '{}': {}", c.name(PassId{i}), c.name(ordering.after),
                           ordering.reason);
      });
  return edges;
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
void refuse_cycle(CompileContext& c, std::vector<uint8_t> stuck, const std::vector<PassId>& done,
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
  auto& diagnostic = c.diagnostics.add(
      DiagnosticId::pass_cycle, c.graph.passes[cycle.front()->before.value].where,
      fmt::format("passes wait for each other: {}'{}'", names, c.name(cycle.front()->before)));
  for (const Edge* edge : cycle)
    diagnostic.related.emplace_back(c.graph.passes[edge->after.value].where, edge->why);
}

} // namespace

void order(CompileContext& c) {
  // A cycle is a mistake even among passes that nothing needs today.
  const auto everywhere = dependencies(c, c.on, false);
  const auto all = sorted(c.on, everywhere);
  const auto count = [](const std::vector<uint8_t>& flags) {
    return static_cast<size_t>(std::count(flags.begin(), flags.end(), 1));
  };
  if (all.size() != count(c.on)) return refuse_cycle(c, c.on, all, everywhere);
  const auto among_live = dependencies(c, c.live, true);
  c.order = sorted(c.live, among_live);
  if (c.order.size() != count(c.live)) refuse_cycle(c, c.live, c.order, among_live);
}

} // namespace dermis
