#pragma once
// The viewer's page: a graph with its plans for the values of its settings, as one HTML file.

#include "integration/tools/command/graph_input.hpp"

#include <string>

namespace dermis::tools {

inline constexpr size_t max_view_configurations = 64; // plans per page

// Inputs of a page in addition to the graph.
struct ViewOptions {
  Size size;
  std::string command;   // command line that makes the page
  std::string frame;     // report of `dermis render --json`; "": none
  CompileChoices chosen; // initial selection
};

struct ViewAnswer {
  std::string page;          // "" with errors in the diagnostics or a `problem`
  std::string problem;       // a problem of the environment
  std::string bad_file = {}; // with errors, if they are not the graph's
  std::string warning = {};  // difference of the report from the page; "": none
};

// Builds the page. Switchable settings are the choices by budget, then booleans and enumerations,
// in file order, as long as they have at most `max_view_configurations` combinations. Other
// settings keep their values.
ViewAnswer make_view(const LoadedGraph& loaded, const ViewOptions& options,
                     Diagnostics& diagnostics);

} // namespace dermis::tools
