#pragma once
// Pareto front of cost and error.

#include <vector>

namespace dermis::tools {

struct Cost {
  double time = 0, error = 0;
};

// Returns true for each entry that no other entry dominates, that is, is better in one value and at
// least equal in the other.
std::vector<bool> pareto_front(const std::vector<Cost>& all);

} // namespace dermis::tools
