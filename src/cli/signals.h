#pragma once
#include <atomic>

namespace candela::cli {

// While one lives, SIGINT and SIGTERM are held: the work in hand comes to a clean end, then the destructor lets the
// signal end the program as it usually would (a shell sees 130 or 143). A second signal ends it at once.
class HeldSignals {
 public:
  HeldSignals();
  ~HeldSignals();
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  const std::atomic<int>& pending() const;  // the signal's number, or 0
};

}  // namespace candela::cli
