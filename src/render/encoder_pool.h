#pragma once
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "image/image.h"
#include "session/session.h"

namespace candela {

// A frame of the reference as files hold it.
struct TracedPicture {
  FloatImage linear;     // without channels: no file needs it
  DisplayImage display;  // likewise, without pixels
};

struct FinishedFrame {
  FrameResult frame;
  int64_t number = 0;
  std::shared_ptr<const TracedPicture> traced;  // of the reference; frame then holds time, notes, warnings and timings
};

struct EncoderLimits {
  size_t workers = 1;
  // Of frames that were pushed and are not yet complete: at most so many, and, where there is more than one, of so many
  // bytes. Memory so depends neither on the length of a film nor on which frame takes longest.
  size_t frames = 3;
  uint64_t bytes = 0;
};

// Encodes finished frames on several threads while others render. What the workers make is completed one frame at a
// time in the order of push, so that files appear, a film grows and errors are told as one worker would: when frame N
// fails, all before it are complete and none after it.
class EncoderPool {
 public:
  // Runs in order, on any worker.
  using Complete = std::move_only_function<Expected<void>()>;
  // Runs on the worker of that number beside others. The frame is released when it returns.
  using Encode = std::function<Expected<Complete>(FinishedFrame& frame, size_t worker)>;

  EncoderPool(EncoderLimits limits, Encode encode);
  ~EncoderPool();  // drops what waits
  EncoderPool(const EncoderPool&) = delete;
  EncoderPool& operator=(const EncoderPool&) = delete;
  // bytes: what the frame takes until it is complete. Blocks while there is no room; false once a frame has failed.
  bool push(FinishedFrame frame, uint64_t bytes);
  Expected<void> finish();  // waits for all; the error of the first frame that failed, or its exception
  // After finish().
  std::optional<int64_t> failed_frame() const { return failed_frame_; }
  size_t most_frames() const { return most_frames_; }  // that were there at once

 private:
  struct Waiting {
    FinishedFrame finished;
    uint64_t place, bytes;
  };
  struct Encoded {
    int64_t number = 0;
    uint64_t bytes = 0;
    Expected<Complete> complete;
    std::exception_ptr exception;
  };
  void run(size_t worker);
  Encoded encode(Waiting job, size_t worker);
  void complete_in_order(std::unique_lock<std::mutex>& lock);
  void end_threads();

  EncoderLimits limits_;
  Encode encode_;
  std::mutex mutex_;
  std::condition_variable work_, room_;
  std::deque<Waiting> waiting_;
  std::map<uint64_t, Encoded> encoded_;  // by place: those whose turn has not come
  uint64_t pushed_ = 0, completed_ = 0;
  size_t frames_ = 0, most_frames_ = 0;
  uint64_t bytes_ = 0;
  bool closing_ = false;
  bool refused_ = false;     // a frame failed: nothing is taken any more
  bool completing_ = false;  // a worker is at it
  bool ended_ = false;       // the failed frame's turn came: nothing is completed any more
  Expected<void> result_;
  std::exception_ptr exception_;
  std::optional<int64_t> failed_frame_;
  std::vector<std::thread> threads_;
};

// How many workers, frames and bytes: as many workers as cores unless said otherwise, two frames more than workers, and
// a quarter of the machine's memory or 4 GiB, whichever is less.
EncoderLimits encoder_limits(int workers);

}  // namespace candela
