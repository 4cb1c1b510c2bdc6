#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "farm/process_identity.h"
#include "render/frame_names.h"

namespace candela {

// What is known of one run of `sequence --record DIR`: written when it begins, while it runs and at its end, whole each
// time, under a name of its own. A run that was killed leaves a record without a code.
struct RunRecord {
  Shard shard;
  std::string node;                           // as the engine calls the machine
  ProcessIdentity process;                    // that made the record
  double started_s = 0, updated_s = 0;        // since 1970, by the clock of its machine
  std::string scene_content, device, driver;  // empty until the device is open
  size_t frames = 0, rendered = 0, skipped = 0;
  std::optional<int> code;  // of exit
  std::string error;
  // Seconds since the file was written, by the file server's clock alone. Read, never written; infinite where the file
  // or what it says is dated ahead of that clock by more than `most_skew_s`.
  double silent_s = 0;
};
// Clocks of machines may differ by so much.
inline constexpr double most_skew_s = 300;

// Keeps a record of this run. It never fails a run: what cannot be written is a warning, once.
class RunRecorder {
 public:
  RunRecorder(std::filesystem::path folder, Shard shard);
  void opened(const std::string& scene_content, const std::string& device, const std::string& driver, size_t frames);
  void progress(size_t rendered, size_t skipped);  // at most every few seconds
  void end(int code, const std::string& error);

 private:
  void write();
  std::filesystem::path file_;
  RunRecord record_;
  double written_s_ = 0;
  bool warned_ = false;
};

double unix_seconds();
// Of all runs, by when they were last written; copies of a record are one run. Files that are no records are left out
// with a warning.
std::vector<RunRecord> read_run_records(const std::filesystem::path& folder);

}  // namespace candela
