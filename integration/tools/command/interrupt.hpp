#pragma once
// Ctrl-C as a question that long work asks: stop at the next good place, so that nothing is left
// half-written.

namespace dermis::tools {

// From now on the first SIGINT or SIGTERM only makes interrupted() true; the second ends the program at once.
void listen_for_interrupts();
// Thread: any.
bool interrupted();

} // namespace dermis::tools
