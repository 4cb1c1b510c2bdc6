#include "farm/run_record.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>

#include "base/files.h"
#include "base/json.h"
#include "base/log.h"
#include "farm/quote.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;
constexpr double progress_s = 15;

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

// Slurm's name of a node need not be the host's.
std::string node_name() {
  const char* slurm = std::getenv("SLURMD_NODENAME");
  return slurm && *slurm ? slurm : host_name();
}

std::string record_json(const RunRecord& record) {
  Json j;
  j["shard"] = record.shard.index;
  j["shards"] = record.shard.count;
  j["node"] = record.node;
  j["host"] = record.host;
  j["process"] = record.process;
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
    record.host = j.at("host");
    record.process = j.at("process");
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
    return fail(ErrorKind::input, file.string(), "is no record of a run: {}", wrong.what());
  }
}

}  // namespace

double unix_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

RunRecorder::RunRecorder(fs::path folder, Shard shard) {
  record_.shard = shard;
  record_.node = node_name();
  record_.host = host_name();
  record_.process = getpid();
  record_.started_s = unix_seconds();
  file_ = folder / fmt::format("{}of{}-{}-{:.0f}-{}.json", shard.index, shard.count, plain_name(record_.node),
                               record_.started_s * 1e3, record_.process);
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
  log::warning("this run is not on record: {}", written.error().text());
}

std::vector<RunRecord> read_run_records(const fs::path& folder) {
  std::vector<RunRecord> records;
  std::error_code failed;
  for (fs::directory_iterator entry(folder, failed), end; !failed && entry != end; entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (name.starts_with('.') || !name.ends_with(".json")) continue;
    if (auto record = read_record(entry->path()))
      records.push_back(std::move(*record));
    else
      log::warning("{}", record.error().text());
  }
  std::stable_sort(records.begin(), records.end(),
                   [](const RunRecord& a, const RunRecord& b) { return a.started_s < b.started_s; });
  return records;
}

}  // namespace candela
