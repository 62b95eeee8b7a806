#pragma once
// The viewer's page: a graph with its plans for the values of its settings, as one HTML file.

#include "integration/tools/command/graph_input.hpp"

#include <string>

namespace dermis::tools {

inline constexpr size_t max_view_outcomes = 64; // plans in one page

// What a page holds beside the graph.
struct ViewOptions {
  Size size;
  std::string command;   // line that made it
  std::string frame;     // report of `dermis render --json`; "": none
  CompileChoices chosen; // what the page opens with
};

struct ViewAnswer {
  std::string page;    // "" with errors in the diagnostics, or with a `problem`
  std::string problem; // what is wrong with the environment
};

// Switched in the page are the choices by budget, then switches and enumerations, in the order of the file,
// as long as their combinations are at most `max_view_outcomes`; other settings keep their values.
ViewAnswer make_view(const LoadedGraph& loaded, const ViewOptions& options, Diagnostics& diagnostics);

} // namespace dermis::tools
