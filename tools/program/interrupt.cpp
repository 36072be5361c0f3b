#include "tools/program/interrupt.hpp"

#include <atomic>
#include <csignal>

namespace ukemi::tools {

namespace {
std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);  // a signal handler may set it
}  // namespace

void catch_interrupts() {
  static std::atomic<bool> caught{false};
  if (caught.exchange(true)) return;
  struct sigaction action {};
  action.sa_handler = [](int) { requested = true; };
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
}

bool interrupted() { return requested; }

}  // namespace ukemi::tools
