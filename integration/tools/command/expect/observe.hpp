#pragma once
// Compiles a graph under the inputs of a case and says what came of it.

#include "integration/tools/command/expect/expectation.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

struct Observation {
  MachineInfo info;
  std::vector<std::string> messages;   // of the diagnostics, for people
  std::string problem;                 // the inputs do not fit the graph: nothing was compiled
  std::vector<std::string> violations; // of the verifier, to a plan that it should have accepted
  std::string not_verified;            // why the verifier gave up; "": it did not
};

Observation observe(const LoadedGraph& loaded, const ExpectedCase& inputs);

// What is observed of a graph that cannot even be read: its messages.
Observation observe_messages(const Diagnostics& diagnostics);

} // namespace dermis::tools
