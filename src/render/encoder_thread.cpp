#include "render/encoder_thread.h"

namespace candela {

EncoderThread::EncoderThread(std::function<Expected<void>(FinishedFrame&)> encode)
    : encode_(std::move(encode)), thread_([this] { run(); }) {}

EncoderThread::~EncoderThread() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool EncoderThread::push(FinishedFrame frame) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return failed_ || waiting_.size() < capacity; });
  if (failed_) return false;
  waiting_.push_back(std::move(frame));
  changed_.notify_all();
  return true;
}

Expected<void> EncoderThread::finish() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (exception_) std::rethrow_exception(exception_);
  return result_;
}

void EncoderThread::run() {
  for (;;) {
    FinishedFrame frame;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return closing_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      frame = std::move(waiting_.front());
      waiting_.pop_front();
    }
    changed_.notify_all();
    Expected<void> result;
    std::exception_ptr exception;
    try {
      result = encode_(frame);
    } catch (...) {
      exception = std::current_exception();
    }
    if (result && !exception) continue;
    {
      const std::lock_guard lock(mutex_);
      failed_ = true;
      result_ = result;
      exception_ = exception;
      waiting_.clear();
    }
    changed_.notify_all();
    return;
  }
}

}  // namespace candela
