#include "farm/run_record.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <map>
#include <tuple>

#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "farm/quote.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr double progress_s = 15;

// Slurm's name of a node need not be the host's.
std::string node_name(const std::string& host) {
  const char* slurm = std::getenv("SLURMD_NODENAME");
  return slurm && *slurm ? slurm : host;
}

std::string record_json(const RunRecord& record) {
  Json j;
  j["shard"] = record.shard.index;
  j["shards"] = record.shard.count;
  j["node"] = record.node;
  j["host"] = record.process.host;
  j["boot"] = record.process.boot;
  j["process"] = record.process.process;
  j["process_start"] = record.process.start;
  j["started"] = record.started_s;
  j["updated"] = record.updated_s;
  j["scene_content"] = record.scene_content;
  j["device"] = record.device;
  j["driver"] = record.driver;
  j["frames"] = record.frames;
  j["rendered"] = record.rendered;
  j["skipped"] = record.skipped;
  if (record.code) j["code"] = *record.code;
  if (!record.error.empty()) j["error"] = record.error;
  return j.dump(2) + "\n";
}

Expected<RunRecord> read_record(const fs::path& file) {
  const auto read = read_json_file(file);
  if (!read) return std::unexpected(read.error());
  const Json& j = *read;
  try {
    RunRecord record;
    record.shard = {j.at("shard"), j.at("shards")};
    record.node = j.at("node");
    record.process = {j.at("host"), j.value("boot", ""), j.at("process"), j.value("process_start", "")};
    record.started_s = j.at("started");
    record.updated_s = j.at("updated");
    record.scene_content = j.at("scene_content");
    record.device = j.at("device");
    record.driver = j.at("driver");
    record.frames = j.at("frames");
    record.rendered = j.at("rendered");
    record.skipped = j.at("skipped");
    if (j.contains("code")) record.code = j.at("code").get<int>();
    if (j.contains("error")) record.error = j.at("error");
    return record;
  } catch (const Json::exception& wrong) {
    return fail(ErrorKind::input, file.string(), "is not the record of a run: {}", wrong.what());
  }
}

// What the file server's clock says, by a file that is written now; this machine's clock where none may be written.
fs::file_time_type server_time(const fs::path& folder) {
  const ProcessIdentity here = this_process();
  const fs::path file = folder / fmt::format(".clock-{}-{}", plain_name(here.host), here.process);
  std::error_code failed;
  fs::file_time_type now = fs::file_time_type::clock::now();
  if (!write_file_atomically(file, "")) return now;
  const fs::file_time_type written = fs::last_write_time(file, failed);
  if (!failed) now = written;
  fs::remove(file, failed);
  return now;
}

double silence_s(const RunRecord& record, fs::file_time_type written, fs::file_time_type now) {
  const double silent_s = std::chrono::duration<double>(now - written).count();
  const auto at = std::chrono::file_clock::to_sys(written).time_since_epoch();
  const double ahead_s = record.updated_s - std::chrono::duration<double>(at).count();
  if (silent_s < -most_skew_s || ahead_s > most_skew_s) return std::numeric_limits<double>::infinity();
  return std::max(silent_s, 0.0);
}

// Of copies the one that says most; where they say the same the oldest file, for copying is no sign of life.
std::vector<RunRecord> without_copies(std::vector<RunRecord> records) {
  using Run = std::tuple<int, std::string, std::string, int, double>;
  std::map<Run, RunRecord> runs;
  for (RunRecord& record : records) {
    const ProcessIdentity& process = record.process;
    const Run run{record.shard.index, record.node, process.host, process.process, record.started_s};
    const auto [place, fresh] = runs.try_emplace(run, record);
    const auto rank = [](const RunRecord& one) {
      return std::tuple(one.updated_s, one.code.has_value(), one.silent_s);
    };
    if (!fresh && rank(record) > rank(place->second)) place->second = std::move(record);
  }
  std::vector<RunRecord> result;
  for (auto& [run, record] : runs) result.push_back(std::move(record));
  return result;
}

}  // namespace

double unix_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

RunRecorder::RunRecorder(fs::path folder, Shard shard) {
  record_.shard = shard;
  record_.process = this_process();
  record_.node = node_name(record_.process.host);
  record_.started_s = unix_seconds();
  file_ = folder / fmt::format("{}of{}-{}-{:.0f}-{}.json", shard.index, shard.count, plain_name(record_.node),
                               record_.started_s * 1e3, record_.process.process);
  std::error_code failed;
  fs::create_directories(folder, failed);  // what went wrong shows when the record is written
  write();
}

void RunRecorder::opened(const std::string& scene_content, const std::string& device, const std::string& driver,
                         size_t frames) {
  record_.scene_content = scene_content;
  record_.device = device;
  record_.driver = driver;
  record_.frames = frames;
  write();
}

void RunRecorder::progress(size_t rendered, size_t skipped) {
  record_.rendered = rendered;
  record_.skipped = skipped;
  if (unix_seconds() - written_s_ >= progress_s) write();
}

void RunRecorder::end(int code, const std::string& error) {
  record_.code = code;
  record_.error = error;
  write();
}

void RunRecorder::write() {
  written_s_ = record_.updated_s = unix_seconds();
  const std::string text = record_json(record_);
  const auto written = replace_file_atomically(file_, std::as_bytes(std::span(text)));
  if (written || std::exchange(warned_, true)) return;
  log::warning("the record of this run could not be written: {}", written.error().text());
}

std::vector<RunRecord> read_run_records(const fs::path& folder) {
  std::vector<RunRecord> records;
  std::error_code failed;
  if (!fs::is_directory(folder, failed)) return records;
  const fs::file_time_type now = server_time(folder);
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') || !name.ends_with(".json")) continue;
    std::error_code gone;
    const fs::file_time_type written = fs::last_write_time(entry->path(), gone);
    auto record = read_record(entry->path());
    if (!record) {
      log::warning("{}", record.error().text());
      continue;
    }
    record->silent_s = silence_s(*record, gone ? now : written, now);
    records.push_back(std::move(*record));
  }
  records = without_copies(std::move(records));
  std::stable_sort(records.begin(), records.end(), [](const RunRecord& a, const RunRecord& b) {
    return a.silent_s != b.silent_s ? a.silent_s > b.silent_s : a.started_s < b.started_s;
  });
  return records;
}

}  // namespace candela
