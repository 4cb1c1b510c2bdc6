#include "cli/progress.h"

#include <unistd.h>

#include <cstdio>

namespace candela::cli {

std::string duration_text(double seconds) {
  const int64_t s = int64_t(seconds + 0.5);
  if (s >= 3600) return fmt::format("{}h{:02}m", s / 3600, s / 60 % 60);
  return s >= 60 ? fmt::format("{}m{:02}s", s / 60, s % 60) : fmt::format("{}s", s);
}

ProgressLine::ProgressLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

void ProgressLine::show(const SequenceProgress& p) {
  if (quiet_) return;
  const double now_us = process_clock_us();
  const bool last = p.done == p.total;
  constexpr double terminal_us = 1e5, plain_us = 5e6;
  if (!last && last_us_ > 0 && now_us - last_us_ < (terminal_ ? terminal_us : plain_us)) return;
  last_us_ = now_us;
  std::string line = fmt::format("{}/{} frames", p.done, p.total);
  if (p.skipped > 0) line += fmt::format(" ({} were there)", p.skipped);
  if (p.frames_per_s > 0) line += fmt::format(", {:.2f} frames/s, {} left", p.frames_per_s, duration_text(p.left_s));
  // \r goes back to the line's start, ESC [K erases what a longer line left.
  const std::string whole = terminal_ ? "\r" + line + "\x1b[K" : line + "\n";
  std::fwrite(whole.data(), 1, whole.size(), stderr);
  open_ = terminal_;
}

void ProgressLine::end() {
  if (open_) std::fputc('\n', stderr);
  open_ = false;
}

}  // namespace candela::cli
