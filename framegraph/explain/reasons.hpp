#pragma once
// Formats the compiler's recorded reasons as sentences: why a pass runs or not, why a barrier
// exists, what a resource became, and which memory is shared.

#include "framegraph/compile/plan.hpp"
#include "framegraph/model/graph.hpp"

#include <string>
#include <vector>

namespace dermis {

// Returns one reason as part of a sentence: "runs: 'blur' reads its 'light'". The reason must have
// been recorded for `graph`, `pass_types` and `plan`.
std::string reason_text(const Graph& graph, const PassTypeRegistry& pass_types, const Plan& plan,
                        const Reason& reason);

// Finds all reasons about one subject.
class ReasonIndex {
public:
  // Keeps references to all three.
  ReasonIndex(const Graph& graph, const PassTypeRegistry& pass_types, const CompiledPlan& compiled);
  std::string about(Reason::About about, uint32_t index) const;

private:
  const Graph& graph_;
  const PassTypeRegistry& pass_types_;
  const CompiledPlan& compiled_;
  std::vector<const Reason*> sorted_; // by subject
};

// Returns for each placement what it shares memory with, and what it cannot share with.
std::vector<std::string> placement_reasons(const Graph& graph, const Plan& plan);

} // namespace dermis
