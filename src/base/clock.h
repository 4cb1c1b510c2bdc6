#pragma once
#include <chrono>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace candela {

using Clock = std::chrono::steady_clock;

inline double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Times the stages of a piece of work one after another, without gaps: their sum is the whole.
class StageClock {
 public:
  // Ends the stage before. A name that comes again gets more time.
  void begin(std::string_view name) {
    end();
    for (auto& [known, ms] : stages_)
      if (known == name) current_ = &ms;
    if (!current_) current_ = &stages_.emplace_back(name, 0).second;
  }
  void restart() { stages_.clear(), current_ = nullptr; }
  void end() {
    const Clock::time_point now = Clock::now();
    if (current_) *current_ += std::chrono::duration<double, std::milli>(now - since_).count();
    since_ = now, current_ = nullptr;
  }
  // Name and milliseconds, in the order of their beginnings.
  std::span<const std::pair<std::string, double>> stages() const { return stages_; }

 private:
  std::vector<std::pair<std::string, double>> stages_;
  double* current_ = nullptr;  // null: none is timed
  Clock::time_point since_{};
};

}  // namespace candela
