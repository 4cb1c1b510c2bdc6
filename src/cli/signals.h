#pragma once
#include <array>
#include <atomic>
#include <csignal>

namespace candela::cli {

// While one lives, SIGINT, SIGTERM and SIGHUP are held: the work in hand comes to a clean end, then the destructor lets
// the signal end the program as it usually would (a shell sees 130, 143 or 129). A second signal ends it at once.
class HeldSignals {
 public:
  HeldSignals();
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  const std::atomic<int>& pending() const;  // the signal's number, or 0

 private:
  static constexpr std::array held = {SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, held.size()> before_;
};

}  // namespace candela::cli
