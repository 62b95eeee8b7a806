#include "integration/tools/command/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace dermis::tools {
namespace {

// Global because a signal handler has no other state.
std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void note_interrupt(int signal) {
  stop_requested.store(true);
  std::signal(signal, SIG_DFL);
}

} // namespace

void listen_for_interrupts() {
  // Without SA_RESTART, a system call that waits returns, and the verb sees the request.
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() {
  return stop_requested.load(std::memory_order_relaxed);
}

demo::Error stopped() {
  return {demo::ErrorKind::environment, "stopped"};
}

} // namespace dermis::tools
