#pragma once
// Which of several things nothing else beats in both cost and error.

#include <vector>

namespace dermis::tools {

struct Cost {
  double time = 0, error = 0;
};

// True for each that no other equals in one and betters in the other, or betters in both.
std::vector<bool> pareto_front(const std::vector<Cost>& all);

} // namespace dermis::tools
