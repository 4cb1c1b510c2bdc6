#pragma once
#include <functional>
#include <limits>

#include "base/clock.h"

namespace candela {

// What is left of a time that was given, from when this was made; without one (0 s) there is always some. stop: of
// signals; its owner outlives this.
class Deadline {
 public:
  Deadline(double budget_s, const std::function<bool()>& stop) : budget_s_(budget_s), stop_(stop) {}
  bool limited() const { return budget_s_ > 0; }
  double elapsed_s() const { return ms_since(start_) / 1000; }
  double left_s() const { return limited() ? budget_s_ - elapsed_s() : std::numeric_limits<double>::infinity(); }
  bool stopped() const { return stop_ && stop_(); }
  bool over() const { return stopped() || left_s() <= 0; }
  double budget_s() const { return budget_s_; }

 private:
  Clock::time_point start_ = Clock::now();
  double budget_s_;
  const std::function<bool()>& stop_;
};

}  // namespace candela
