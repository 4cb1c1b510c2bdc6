#include "cli/signals.h"

#include <unistd.h>

namespace candela::cli {
namespace {

std::atomic<int> pending_signal{0};
static_assert(std::atomic<int>::is_always_lock_free);

void hold(int signal) {
  if (pending_signal.exchange(signal) != 0) _exit(128 + signal);
}

}  // namespace

HeldSignals::HeldSignals() {
  struct sigaction action {};
  action.sa_handler = hold;
  action.sa_flags = SA_RESTART;
  for (size_t i = 0; i < held.size(); ++i) {
    sigaction(held[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) sigaction(held[i], &action, nullptr);  // nohup ignores SIGHUP
  }
}
HeldSignals::~HeldSignals() {
  for (size_t i = 0; i < held.size(); ++i) sigaction(held[i], &before_[i], nullptr);
  if (const int signal = pending_signal.exchange(0)) raise(signal);
}
const std::atomic<int>& HeldSignals::pending() const { return pending_signal; }

}  // namespace candela::cli
