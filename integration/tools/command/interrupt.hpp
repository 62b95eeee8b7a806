#pragma once
// Handles Ctrl-C: long work polls for it and stops at a point where no file is half-written.

namespace dermis::tools {

// Installs handlers. The first SIGINT or SIGTERM makes interrupted() true; the second ends the
// program at once.
void listen_for_interrupts();
// Thread: any.
bool interrupted();

} // namespace dermis::tools
