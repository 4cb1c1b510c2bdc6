#pragma once
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "farm/farm_job.h"
#include "farm/run_record.h"

namespace candela {

// header: the files are there, as long as they were, and say that they hold this job's picture; whole: all of their
// bytes are those that were written.
enum class FrameLook { header, whole };

enum class ShardStage {
  done,
  running,  // its last run has not ended and was heard of lately
  failed,   // its last run has ended with a code, or without a word
  waiting   // not begun, or ended well and frames have gone since
};
const char* stage_name(ShardStage stage);

struct ShardState {
  int index = 1;
  ShardStage stage = ShardStage::waiting;
  size_t frames = 0;
  std::vector<int64_t> missing;  // or damaged
  std::vector<int64_t> damaged;  // of them: files are there, but not whole or of another picture
  std::vector<RunRecord> runs;   // by their start
};

struct FarmState {
  size_t frames = 0, done = 0;
  size_t failed = 0;   // frames that are not there, of shards that failed
  size_t missing = 0;  // frames that are not there, of the others
  size_t damaged = 0;  // frames whose files are there, but not whole or of another picture
  std::vector<ShardState> shards;
  std::vector<std::string> devices;  // that made frames, with their drivers
  double rendered_per_s = 0;         // over the time in which at least one run was going; 0: unknown
  double seconds_left = 0;           // at this rate
  bool complete() const { return done == frames; }
};

struct FarmLook {
  FrameLook frames = FrameLook::header;
  double lost_after_s = 600;  // a run that is silent for longer is taken for dead
};
Expected<FarmState> look_at_farm(const FarmJob& job, const FarmLook& look);

// What to do about a shard whose frames are not all there, by how its last run ended:
// 2, 3, 7 (usage, input, pixels that are not finite) would end alike everywhere: never again. 4 (device) elsewhere than
// on the nodes where it happened. 6 (memory), and runs that were killed without a word, which is what the limits of
// engines and the kernel do when memory ends: again with twice the memory for each such run. Everything else again.
struct Remedy {
  enum class Kind { again, never, wait } kind = Kind::again;  // wait: it is running
  std::set<std::string> exclude;                              // nodes
  int memory_factor = 1;
  auto operator<=>(const Remedy&) const = default;
};
const char* remedy_name(Remedy::Kind kind);
Remedy remedy_of(const ShardState& shard);

}  // namespace candela
