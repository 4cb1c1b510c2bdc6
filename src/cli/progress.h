#pragma once
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "render/sequence.h"

namespace candela::cli {

std::string duration_text(double seconds);  // "2m05s"

// How far a job is, on stderr: one line that is written over on a terminal, a plain line every few seconds elsewhere,
// an event of the log where that is JSON.
class StatusLine {
 public:
  explicit StatusLine(bool quiet);
  ~StatusLine() { end(); }
  // Whether it is time for a line; the last one of a job always is.
  bool due(bool last = false);
  void show(const std::string& line, const nlohmann::ordered_json& members);
  void end();  // leaves the last line standing

 private:
  bool quiet_, terminal_, open_ = false;
  double last_us_ = 0;
};

// Says what one picture waits for, where the program has run for two seconds: on a terminal and in JSON again and
// again, elsewhere once in half a minute. While it lives the log must be gathered (base/log_gather.h).
class WaitingLine {
 public:
  WaitingLine(std::string what, bool quiet);  // what: "rendering"
  ~WaitingLine();
  WaitingLine(const WaitingLine&) = delete;
  WaitingLine& operator=(const WaitingLine&) = delete;
  static bool left_a_line();  // that stays, elsewhere than on a terminal

 private:
  void run();
  std::string what_;
  bool terminal_, ended_ = false, shown_ = false;
  std::mutex mutex_;
  std::condition_variable end_;
  std::thread thread_;  // none: it stays silent
};

class ProgressLine {
 public:
  explicit ProgressLine(bool quiet) : line_(quiet) {}
  void show(const SequenceProgress& progress);
  void end() { line_.end(); }

 private:
  StatusLine line_;
};

}  // namespace candela::cli
