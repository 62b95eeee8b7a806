#include "integration/tools/command/bench/report/pareto.hpp"

#include <algorithm>

namespace dermis::tools {

std::vector<bool> pareto_front(const std::vector<Cost>& all) {
  std::vector<bool> front;
  for (const Cost& one : all)
    front.push_back(std::none_of(all.begin(), all.end(), [&](const Cost& other) {
      return other.time <= one.time && other.error <= one.error &&
             (other.time < one.time || other.error < one.error);
    }));
  return front;
}

} // namespace dermis::tools
