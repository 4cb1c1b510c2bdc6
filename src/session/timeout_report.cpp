#include "session/timeout_report.h"

#include "base/files.h"
#include "base/log_form.h"

namespace candela {

Error as_error(const gpu::GpuError& error, const gpu::Device* device) {
  Error result{error.out_of_memory() ? ErrorKind::out_of_memory : ErrorKind::device, error.what(), error.place};
  if (!device || !error.out_of_memory()) return result;
  const auto mib = [](uint64_t bytes) { return (bytes + (1 << 20) - 1) >> 20; };
  const gpu::Device::MemoryUse use = device->memory_use();
  result.message += fmt::format(
      " (on the device: {} MiB of textures, meshes and sky, {} of the frame's images and buffers, {} for "
      "its outputs)",
      mib(use.scene), mib(use.frame), mib(use.readback));
  return result;
}
namespace fs = std::filesystem;

Expected<fs::path> write_timeout_report(const fs::path& where, const TimeoutReport& report) {
  std::error_code failed;
  fs::create_directories(where.empty() ? fs::path(".") : where, failed);
  fs::path folder;
  for (int n = 1; !failed; ++n) {
    folder = where / (n == 1 ? "candela-timeout" : fmt::format("candela-timeout-{}", n));
    if (fs::create_directory(folder, failed)) break;
  }
  if (failed) return fail(ErrorKind::output, folder.string(), "cannot be made: {}", failed.message());
  std::string log;
  for (const std::string& line : log::recent_lines()) log += line + "\n";
  const std::pair<const char*, std::string> files[] = {{"command.sh", report.command + "\n"},
                                                       {"job.json", report.job + "\n"},
                                                       {"versions.txt", report.versions},
                                                       {"plan.txt", report.plan},
                                                       {"log.txt", log + report.message + "\n"}};
  for (const auto& [name, text] : files)
    if (auto written = write_file_atomically(folder / name, std::string_view(text)); !written)
      return std::unexpected(written.error());
  return folder;
}

std::string kept_timeout(const RunSettings& settings, const Job& job, const gpu::DeviceInfo& device,
                         const FramePlan& plan, const std::string& message) {
  const auto folder = write_timeout_report(
      settings.timeout_folder,
      {.command = settings.command,
       .job = job_json(job),
       .versions = fmt::format("candela {}\n{}\n{}\n", CANDELA_VERSION, device.name, device.driver),
       .plan = plan_text(plan),
       .message = message});
  return folder ? fmt::format("; {} holds command, job, versions, plan and log", folder->string())
                : fmt::format("; what shows why could not be kept: {}", folder.error().text());
}

}  // namespace candela
