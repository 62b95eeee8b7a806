#pragma once
// Which kinds of reuse a graph offers.

#include "framegraph/model/graph.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

struct RestirVariant {
  std::string reuse = "none";
  std::string shift; // "": nothing is shifted

  bool has_history() const { return reuse == "temporal" || reuse == "spatiotemporal"; }
};

// "none" first; then every reuse with every shift, as the graph's settings `reuse` and `shift` list them. A
// graph without them has "none" alone.
std::vector<RestirVariant> variants_of(const Graph& graph);

// Mean square error of independent samples falls with their number, and so with time: an error times its
// time is what a technique makes of a unit of both. Below 1: nearer to the truth than without reuse in the
// same time.
double ratio_at_equal_time(double mse, double ms, double mse_of_none, double ms_of_none);

} // namespace dermis::tools
