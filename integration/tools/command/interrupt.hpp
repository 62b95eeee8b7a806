#pragma once
// Handles Ctrl-C: long work polls for it and stops at a point where no file is half-written.

#include "integration/examples/demo_engine/result.hpp"

namespace dermis::tools {

// Installs handlers. The first SIGINT or SIGTERM makes interrupted() true; the second ends the
// program at once.
void listen_for_interrupts();
// Thread: any.
bool interrupted();
// The error of an interrupted run.
demo::Error stopped();

} // namespace dermis::tools
