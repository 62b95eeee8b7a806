#pragma once
// Sentences of what the compiler noted down: why a pass runs or not, where a barrier comes from, what a
// resource became, which memory is shared.

#include "framegraph/compile/plan.hpp"
#include "framegraph/model/graph.hpp"

#include <string>
#include <vector>

namespace dermis {

// One reason as part of a sentence: "runs: 'blur' reads its 'light'". `graph`, `pass_types` and `plan` are
// those it was noted for.
std::string reason_text(const Graph& graph, const PassTypeRegistry& pass_types, const Plan& plan,
                        const Reason& reason);

// All reasons about one thing, in the order in which they were found, with "; " between them; "" for none.
class ReasonIndex {
public:
  // Keeps references to all three.
  ReasonIndex(const Graph& graph, const PassTypeRegistry& pass_types, const CompiledPlan& compiled);
  std::string about(Reason::About about, uint32_t index) const;

private:
  const Graph& graph_;
  const PassTypeRegistry& pass_types_;
  const CompiledPlan& compiled_;
  std::vector<const Reason*> sorted_; // by what they are about
};

// By placement: with what it shares memory, and with what it cannot.
std::vector<std::string> placement_reasons(const Graph& graph, const Plan& plan);

} // namespace dermis
