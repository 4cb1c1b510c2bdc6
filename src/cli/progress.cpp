#include "cli/progress.h"

#include <unistd.h>

#include <atomic>
#include <cstdio>

#include "base/log_form.h"

namespace candela::cli {

std::string duration_text(double seconds) {
  const int64_t s = int64_t(seconds + 0.5);
  if (s >= 3600) return fmt::format("{}h{:02}m", s / 3600, s / 60 % 60);
  return s >= 60 ? fmt::format("{}m{:02}s", s / 60, s % 60) : fmt::format("{}s", s);
}

StatusLine::StatusLine(bool quiet)
    : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1 && log::form() == log::Form::text) {}

bool StatusLine::due(bool last) {
  if (quiet_) return false;
  constexpr double terminal_us = 1e5, plain_us = 5e6;
  const double now_us = process_clock_us();
  if (!last && last_us_ > 0 && now_us - last_us_ < (terminal_ ? terminal_us : plain_us)) return false;
  last_us_ = now_us;
  return true;
}

void StatusLine::show(const std::string& line, const nlohmann::ordered_json& members) {
  const bool json = log::form() == log::Form::json;
  // \r goes back to the line's start, ESC [K erases what a longer line left.
  log::event("progress", json ? line : terminal_ ? "\r" + line + "\x1b[K" : line + "\n", members);
  open_ = terminal_;
}

void StatusLine::end() {
  if (open_) std::fputc('\n', stderr);
  open_ = false;
}

namespace {
std::atomic<bool> a_line_stays{false};
}  // namespace

bool WaitingLine::left_a_line() { return a_line_stays; }

WaitingLine::WaitingLine(std::string what, bool quiet)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1 && log::form() == log::Form::text) {
  if (!quiet) thread_ = std::thread([this] { run(); });
}

WaitingLine::~WaitingLine() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  end_.notify_all();
  thread_.join();
  if (shown_ && terminal_) log::event("progress", "\r\x1b[K", {});
}

void WaitingLine::run() {
  static double last_s = 0;  // since the program began; one line waits at a time
  constexpr double first_s = 2;
  const double again_s = terminal_ ? 0.5 : log::form() == log::Form::json ? 5 : 30;
  std::unique_lock lock(mutex_);
  while (!ended_) {
    const double now_s = process_clock_us() * 1e-6, next_s = last_s == 0 ? first_s : last_s + again_s;
    if (now_s < next_s) {
      end_.wait_for(lock, std::chrono::duration<double>(next_s - now_s));
      continue;
    }
    last_s = now_s;
    const std::string line = fmt::format("{}, {} so far", what_, duration_text(now_s));
    const bool json = log::form() == log::Form::json;
    log::event("progress", json ? line : terminal_ ? "\r" + line + "\x1b[K" : line + "\n", {{"seconds", now_s}});
    shown_ = true;
    if (!terminal_) a_line_stays = true;
  }
}

void ProgressLine::show(const SequenceProgress& p) {
  if (!line_.due(p.done == p.total)) return;
  nlohmann::ordered_json members = {{"done", p.done}, {"skipped", p.skipped}, {"total", p.total}};
  std::string line = fmt::format("{}/{} frames", p.done, p.total);
  if (p.frame) {
    line += fmt::format(", frame {}", *p.frame);
    members["frame"] = *p.frame;
  }
  if (p.skipped > 0) line += fmt::format(" ({} were there)", p.skipped);
  if (p.frames_per_s > 0) {
    line += fmt::format(", {:.2f} frames/s, {} left", p.frames_per_s, duration_text(p.left_s));
    members["frames_per_s"] = p.frames_per_s, members["left_s"] = p.left_s;
  }
  line_.show(line, members);
}

}  // namespace candela::cli
