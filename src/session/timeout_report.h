#pragma once
#include <filesystem>
#include <string>

#include "base/error.h"

namespace candela {

// What it takes to see again why a frame did not end in time.
struct TimeoutReport {
  std::string command;   // line, as a shell takes it
  std::string job;       // as JSON
  std::string versions;  // of program, device and driver, a line each
  std::string plan;      // of the frame
  std::string message;   // the error: which pass the device had come to
};

// Writes it, with the log's lines so far, into a new folder inside `where`: candela-timeout, or candela-timeout-2 and
// so on where there is one. The folder. Errors (output).
Expected<std::filesystem::path> write_timeout_report(const std::filesystem::path& where, const TimeoutReport& report);

}  // namespace candela
