#include "cli/signals.h"

#include <unistd.h>
#include <csignal>

namespace candela::cli {
namespace {

std::atomic<int> pending_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

void hold(int signal) {
  if (pending_signal.exchange(signal) != 0) _exit(128 + signal);
}

void set_both(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

HeldSignals::HeldSignals() { set_both(hold); }
HeldSignals::~HeldSignals() {
  set_both(SIG_DFL);
  if (const int signal = pending_signal.exchange(0)) raise(signal);
}
const std::atomic<int>& HeldSignals::pending() const { return pending_signal; }

}  // namespace candela::cli
