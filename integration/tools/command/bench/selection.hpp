#pragma once
// Helpers of the suites: row selection by the user, and the error of an interrupted run.

#include "integration/examples/demo_engine/result.hpp"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace dermis::tools {

// Returns whether `name` is among `only`; an empty list selects every name.
inline bool is_selected(std::span<const std::string> only, std::string_view name) {
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

inline demo::Error stopped() {
  return {demo::ErrorKind::environment, "stopped"};
}

} // namespace dermis::tools
