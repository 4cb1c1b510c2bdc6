#pragma once
#include <filesystem>
#include <string>

#include "base/error.h"
#include "gpu/device.h"
#include "graph/plan.h"
#include "job/job.h"

namespace candela {

// Where memory ran out, with what takes it. device: may be null.
Error as_error(const gpu::GpuError& error, const gpu::Device* device);

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

// Writes it into the folder of the settings and says where it lies, or why it could not be kept, as the end of a
// sentence.
std::string kept_timeout(const RunSettings& settings, const Job& job, const gpu::DeviceInfo& device,
                         const FramePlan& plan, const std::string& message);

}  // namespace candela
