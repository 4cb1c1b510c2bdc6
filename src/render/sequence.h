#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "render/encoder_pool.h"
#include "render/film_format.h"
#include "render/frame_names.h"
#include "render/prepare_outputs.h"
#include "session/session.h"

namespace candela {

struct SequenceProgress {
  size_t done = 0, skipped = 0, total = 0;  // skipped ones count as done
  double frames_per_s = 0, left_s = 0;      // of rendered frames; 0 while unknown
  std::optional<int64_t> frame;             // the number of the newest
};

struct SequenceSettings {
  FrameList frames;  // of this shard, in the order they are rendered
  FrameRate rate;
  std::vector<FramePattern> patterns;
  bool resume = false;                     // skip frames whose files are all whole and hold this job's picture
  FilmFile film;                           // no path: none is made
  std::optional<FramePattern> kept;        // PNG frames of the film until it is made; none: `patterns` has PNG files
  int in_flight = 0;                       // frames begun before the first of them is finished; 0: as the session says
  int encoders = 0;                        // threads that encode and write; 0: as many as cores
  bool keep_spans = false;                 // for a trace; grows with the number of frames
  const std::atomic<int>* stop = nullptr;  // not 0: finish the frames that have begun, then stop
  std::function<void(const SequenceProgress&)> progress;  // after each frame, from the rendering thread
  // For several processes that share the list; the number is the place in it. claim: whether this process is to make
  // the frame. finished: its files are there; false: they were there before.
  std::function<bool(size_t)> claim;
  std::function<void(size_t, bool)> finished;
  // Before a frame is encoded; an error ends the run, and the frame is not written.
  std::function<Expected<void>(int64_t, const FrameResult&)> rendered;
};

struct SequenceResult {
  size_t rendered = 0, skipped = 0;
  bool stopped = false;
  size_t most_frames = 0;            // largest number of frames that were encoded or waited for it at once
  Timings timings;                   // sums over the rendered frames
  std::vector<Hash128> plan_hashes;  // the different ones, in order of appearance
  FramePlan plan;                    // of the last rendered frame
};

// Who makes the frames of a sequence.
class FrameMaker {
 public:
  virtual ~FrameMaker() = default;
  virtual size_t in_flight() const = 0;  // frames begun before the first of them is finished, at least 1
  virtual Expected<void> begin(double time_s) = 0;
  // The oldest frame that has begun; none: `stop` abandoned it.
  virtual Expected<std::optional<FinishedFrame>> finish(int64_t number) = 0;
  // The identity that its files hold.
  virtual std::string identity(double time_s, int64_t number, FrameRate rate) const = 0;
  // Memory that a frame takes until its files are written.
  virtual uint64_t bytes_in_hand(const FinishedFrame& frame) const = 0;
  // On any thread, several at once.
  virtual Expected<PreparedOutputs> prepare(FinishedFrame& frame, FrameRate rate,
                                            const std::vector<std::filesystem::path>& paths,
                                            bool display_wanted) const = 0;
};

// Errors (usage) before anything is rendered: a pattern without a number for more than one frame, two files of one
// name, no output at all; (output): a folder that cannot be written.
Expected<void> check_sequence(const SequenceSettings& settings);
// Folders of all files of frames.
std::set<std::filesystem::path> folders_of(const SequenceSettings& settings);
WantedOutputs wanted_by(const SequenceSettings& settings, const Job& job);

// Renders the frames; read-back copies, encoding and writing of earlier ones, several at once, overlap the rendering of
// the next, and where the session has several in flight, planning and upload of the next too. Every file appears whole
// or not at all, and in the order of frames. The first error ends the run and names its frame; frames before it are
// written, those after it are not.
Expected<SequenceResult> run_sequence(FrameMaker& maker, const Job& job, const SequenceSettings& settings);
Expected<SequenceResult> run_sequence(Session& session, const Job& job, const SequenceSettings& settings);

}  // namespace candela
