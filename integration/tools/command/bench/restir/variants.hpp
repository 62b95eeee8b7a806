#pragma once
// Enumerates the kinds of reuse of a graph.

#include "framegraph/model/graph.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

struct RestirVariant {
  std::string reuse = "none";
  std::string shift; // "": no shift

  bool has_history() const { return reuse == "temporal" || reuse == "spatiotemporal"; }
};

// Returns "none" first, then every reuse with every shift, as listed by the graph's settings
// `reuse` and `shift`. A graph without these settings has only "none".
std::vector<RestirVariant> variants_of(const Graph& graph);

// The mean square error of independent samples falls with their number, and so with time. Error
// times time is therefore a technique's efficiency. A ratio below 1 means a smaller error than
// without reuse in equal time.
double ratio_at_equal_time(double mse, double ms, double mse_of_none, double ms_of_none);

} // namespace dermis::tools
