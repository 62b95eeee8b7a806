#pragma once
// Exit codes of the command. docs/tools.md, `dermis --help` and the manual page repeat the list,
// and add 141: the signal SIGPIPE ends the command (128 + 13 in a shell).

namespace dermis::tools {

enum class ExitCode : int {
  ok = 0,
  problems = 1,      // a file, the graph or the data has problems
  usage = 2,         // invalid option or value
  environment = 3,   // no driver, output that cannot be written, or a missing package
  internal = 4,      // a defect of the program
  interrupted = 130, // Ctrl-C, in the shell's convention: 128 + SIGINT
};

} // namespace dermis::tools
