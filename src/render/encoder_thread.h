#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "frame/session.h"

namespace candela {

struct FinishedFrame {
  FrameResult frame;
  int64_t number = 0;
};

// Encodes and writes frame N while N+1 renders. At most two frames wait, so memory stays bounded when encoding is
// slower.
class EncoderThread {
 public:
  explicit EncoderThread(std::function<Expected<void>(FinishedFrame&)> encode);
  ~EncoderThread();                // drops what waits
  bool push(FinishedFrame frame);  // blocks while full; false once encoding has failed
  Expected<void> finish();         // waits for all; the first error, or the exception that ended the thread

 private:
  void run();
  static constexpr size_t capacity = 2;
  std::function<Expected<void>(FinishedFrame&)> encode_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<FinishedFrame> waiting_;
  bool closing_ = false, failed_ = false;
  Expected<void> result_;
  std::exception_ptr exception_;
  std::thread thread_;
};

}  // namespace candela
