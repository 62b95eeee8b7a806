#pragma once
// Compiles a graph with the inputs of a case and returns the result.

#include "integration/tools/command/expect/expectation.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

struct Observation {
  MachineInfo info;
  std::vector<std::string> messages;   // text of the diagnostics
  std::string problem;                 // inputs that do not fit the graph; nothing was compiled
  std::vector<std::string> violations; // found by the verifier: a defect of the compiler
  std::string not_verified;            // reason why the verifier gave up; "" if it finished
};

Observation observe(const LoadedGraph& loaded, const ExpectedCase& inputs);

// Returns the observation of a graph that cannot be read: its messages.
Observation observe_messages(const Diagnostics& diagnostics);

} // namespace dermis::tools
