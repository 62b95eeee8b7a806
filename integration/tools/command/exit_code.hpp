#pragma once
// What the shell sees. The one list of exit codes; README.md and `dermis --help` repeat it.

namespace dermis::tools {

enum class ExitCode : int {
  ok = 0,
  problems = 1,      // the input has problems: a file, the graph, the data
  usage = 2,         // a bad option or value
  environment = 3,   // no driver, output that cannot be written, a missing package
  internal = 4,      // a defect of the program
  interrupted = 130, // Ctrl-C, as shells count it: 128 + SIGINT
};

} // namespace dermis::tools
