#include "farm/farm_state.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <thread>
#include <tuple>

#include "farm/quote.h"
#include "render/outputs.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

// What, beside the job, decides the bytes of a frame. Several where machines differ.
using Maker = std::tuple<std::string, std::string, std::string>;  // scene content, device, driver

std::vector<Maker> makers_of(const std::vector<RunRecord>& records) {
  std::set<Maker> makers;
  for (const RunRecord& record : records)
    if (!record.device.empty()) makers.emplace(record.scene_content, record.device, record.driver);
  return {makers.begin(), makers.end()};
}

class Frames {
 public:
  Frames(const FarmJob& job, const FarmLook& look, const std::vector<RunRecord>& records)
      : job_(job), look_(look), makers_(makers_of(records)), list_(job.frame_list()), rate_(job.rate()) {}

  // By the place in the list, several files at once: their reading takes most of the time.
  std::vector<FileState> states() const {
    std::vector<FileState> result(list_.size(), FileState::missing);
    const std::vector<size_t> there = places_with_files();
    std::atomic<size_t> next = 0;
    const auto work = [&] {
      for (size_t i = next++; i < there.size(); i = next++) result[there[i]] = state_of(list_[there[i]]);
    };
    const size_t most = std::clamp<size_t>(std::thread::hardware_concurrency(), 1, 16);
    std::vector<std::jthread> others;
    while (others.size() + 1 < std::min(most, there.size())) others.emplace_back(work);
    work();
    others.clear();
    return result;
  }

 private:
  // Folders are listed, not asked for each of the files that may be missing.
  std::vector<size_t> places_with_files() const {
    std::vector<uint8_t> files(list_.size());
    size_t patterns = 0;
    for (const std::string& output : job_.outputs) {
      const FramePattern pattern = *parse_pattern(output);
      const fs::path folder = fs::path(pattern.name(0)).parent_path();
      if (!pattern.numbered || pattern.after_number().find('/') != std::string::npos) {
        for (size_t i = 0; i < list_.size(); ++i) ++files[i];  // may be there
      } else {
        std::error_code failed;
        for (fs::directory_iterator at(job_.work / folder, failed), end; !failed && at != end; at.increment(failed))
          if (const auto frame = pattern.frame_of(folder / at->path().filename()))
            if (const auto place = list_.place_of(*frame)) ++files[*place];
      }
      ++patterns;
    }
    std::vector<size_t> places;
    for (size_t i = 0; i < files.size(); ++i)
      if (files[i] == patterns) places.push_back(i);
    return places;
  }

  FileState state_of(int64_t frame) const {
    const std::vector<fs::path> files = job_.files(frame);
    std::error_code failed;
    for (const fs::path& file : files)
      if (!fs::exists(file, failed)) return FileState::missing;
    for (const auto& [content, device, driver] : makers_) {
      const std::string identity = file_identity(job_.job, content, device, driver, rate_.seconds(frame), frame, rate_);
      const auto holds = [&](const fs::path& file) {
        return look_.frames == FrameLook::whole ? holds_frame(file, identity)
                                                : header_state(file, identity) == FileState::whole;
      };
      if (std::all_of(files.begin(), files.end(), holds)) return FileState::whole;
    }
    return FileState::damaged;
  }

  const FarmJob& job_;
  const FarmLook& look_;
  std::vector<Maker> makers_;
  FrameList list_;
  FrameRate rate_;
};

ShardStage stage_of(const ShardState& shard, double lost_after_s) {
  if (shard.missing.empty()) return ShardStage::done;
  if (shard.runs.empty()) return ShardStage::waiting;
  const RunRecord& last = shard.runs.back();
  if (!last.code) {
    const bool gone = life_of(last.process) == Life::gone;
    return !gone && last.silent_s < lost_after_s ? ShardStage::running : ShardStage::failed;
  }
  return *last.code == 0 ? ShardStage::waiting : ShardStage::failed;
}

// Seconds in which at least one of the runs was going.
double busy_seconds(std::vector<RunRecord> records) {
  std::stable_sort(records.begin(), records.end(),
                   [](const RunRecord& a, const RunRecord& b) { return a.started_s < b.started_s; });
  double sum = 0, until = 0;
  for (const RunRecord& record : records) {
    const double from = std::max(record.started_s, until);
    if (record.updated_s > from) sum += record.updated_s - from;
    until = std::max(until, record.updated_s);
  }
  return sum;
}

}  // namespace

const char* stage_name(ShardStage stage) {
  switch (stage) {
    case ShardStage::done:
      return "done";
    case ShardStage::running:
      return "running";
    case ShardStage::failed:
      return "failed";
    case ShardStage::waiting:
      return "waiting";
  }
  return "";
}

const char* remedy_name(Remedy::Kind kind) {
  switch (kind) {
    case Remedy::Kind::again:
      return "again";
    case Remedy::Kind::never:
      return "never";
    case Remedy::Kind::wait:
      return "wait";
  }
  return "";
}

Expected<FarmState> look_at_farm(const FarmJob& job, const FarmLook& look) {
  std::vector<RunRecord> records = read_run_records(farm_records(job.folder));
  std::erase_if(records, [&](const RunRecord& record) {
    return record.shard.count != job.shards || record.shard.index < 1 || record.shard.index > job.shards;
  });
  const FrameList frames = job.frame_list();
  const std::vector<FileState> files = Frames(job, look, records).states();
  FarmState state{.frames = frames.size()};
  state.shards.resize(size_t(job.shards));
  for (int i = 0; i < job.shards; ++i) state.shards[size_t(i)].index = i + 1;
  for (size_t i = 0; i < frames.size(); ++i) {
    ShardState& shard = state.shards[i % state.shards.size()];
    ++shard.frames;
    state.done += files[i] == FileState::whole;
    if (files[i] == FileState::whole) continue;
    shard.missing.push_back(frames[i]);
    if (files[i] == FileState::damaged) shard.damaged.push_back(frames[i]);
  }
  size_t rendered = 0;
  std::set<std::string> devices;
  for (RunRecord& record : records) {
    rendered += record.rendered;
    if (record.rendered > 0) devices.insert(record.device + " (" + record.driver + ")");
    state.shards[size_t(record.shard.index - 1)].runs.push_back(record);
  }
  state.devices.assign(devices.begin(), devices.end());
  for (ShardState& shard : state.shards) {
    shard.stage = stage_of(shard, look.lost_after_s);
    const size_t absent = shard.missing.size() - shard.damaged.size();
    (shard.stage == ShardStage::failed ? state.failed : state.missing) += absent;
    state.damaged += shard.damaged.size();
  }
  const double busy_s = busy_seconds(records);
  if (rendered > 0 && busy_s > 0) {
    state.rendered_per_s = double(rendered) / busy_s;
    state.seconds_left = double(state.frames - state.done) / state.rendered_per_s;
  }
  return state;
}

Remedy remedy_of(const ShardState& shard) {
  Remedy remedy;
  if (shard.stage == ShardStage::running) return {.kind = Remedy::Kind::wait};
  if (shard.runs.empty()) return remedy;
  constexpr int most_memory = 64;
  for (const RunRecord& run : shard.runs) {
    const int code = run.code.value_or(int(ErrorKind::out_of_memory));
    if (code == int(ErrorKind::device) && plain_name(run.node) == run.node) remedy.exclude.insert(run.node);
    if (code == int(ErrorKind::out_of_memory) && remedy.memory_factor < most_memory) remedy.memory_factor *= 2;
  }
  switch (shard.runs.back().code.value_or(int(ErrorKind::out_of_memory))) {
    case int(ErrorKind::usage):
    case int(ErrorKind::input):
    case int(ErrorKind::nonfinite):
      return {.kind = Remedy::Kind::never};
    default:
      return remedy;
  }
}

}  // namespace candela
