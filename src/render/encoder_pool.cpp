#include "render/encoder_pool.h"

#include <unistd.h>

#include <algorithm>

#include "base/check.h"

namespace candela {

EncoderPool::EncoderPool(EncoderLimits limits, Encode encode) : limits_(limits), encode_(std::move(encode)) {
  CHECK(limits_.workers > 0 && limits_.frames > 0);
  try {
    for (size_t worker = 0; worker < limits_.workers; ++worker) threads_.emplace_back([this, worker] { run(worker); });
  } catch (...) {
    end_threads();
    throw;
  }
}

EncoderPool::~EncoderPool() {
  {
    const std::lock_guard lock(mutex_);
    waiting_.clear();
  }
  end_threads();
}

void EncoderPool::end_threads() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  work_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

bool EncoderPool::push(FinishedFrame frame, uint64_t bytes) {
  std::unique_lock lock(mutex_);
  room_.wait(lock,
             [&] { return refused_ || frames_ == 0 || (frames_ < limits_.frames && bytes_ + bytes <= limits_.bytes); });
  if (refused_) return false;
  most_frames_ = std::max(most_frames_, ++frames_);
  bytes_ += bytes;
  waiting_.push_back({std::move(frame), pushed_++, bytes});
  work_.notify_one();
  return true;
}

Expected<void> EncoderPool::finish() {
  end_threads();
  if (exception_) std::rethrow_exception(exception_);
  return result_;
}

void EncoderPool::run(size_t worker) {
  std::unique_lock lock(mutex_);
  for (;;) {
    work_.wait(lock, [&] { return closing_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    Waiting job = std::move(waiting_.front());
    waiting_.pop_front();
    const uint64_t place = job.place;
    lock.unlock();
    Encoded encoded = encode(std::move(job), worker);
    lock.lock();
    if (!encoded.complete || encoded.exception) {
      refused_ = true;
      waiting_.clear();  // all of them come after this one
      room_.notify_all();
    }
    if (!ended_) encoded_.emplace(place, std::move(encoded));
    complete_in_order(lock);
  }
}

EncoderPool::Encoded EncoderPool::encode(Waiting job, size_t worker) {
  Encoded encoded{.number = job.finished.number, .bytes = job.bytes, .complete = Complete(), .exception = nullptr};
  try {
    encoded.complete = encode_(job.finished, worker);
  } catch (...) {
    encoded.exception = std::current_exception();
  }
  return encoded;
}

// Who comes while another is at it leaves its frame to that one.
void EncoderPool::complete_in_order(std::unique_lock<std::mutex>& lock) {
  while (!completing_ && !ended_) {
    const auto next = encoded_.find(completed_);
    if (next == encoded_.end()) return;
    Encoded encoded = std::move(next->second);
    encoded_.erase(next);
    completing_ = true;
    lock.unlock();
    Expected<void> result;
    if (!encoded.complete) {
      result = std::unexpected(encoded.complete.error());
    } else if (!encoded.exception) {
      try {
        result = (*encoded.complete)();
        encoded.complete = Complete();  // what it holds goes before its place is free
      } catch (...) {
        encoded.exception = std::current_exception();
      }
    }
    lock.lock();
    completing_ = false;
    ++completed_;
    --frames_;
    bytes_ -= encoded.bytes;
    if (!result || encoded.exception) {
      refused_ = ended_ = true;
      result_ = std::move(result);
      exception_ = encoded.exception;
      failed_frame_ = encoded.number;
      waiting_.clear();
      encoded_.clear();
    }
    room_.notify_all();
  }
}

EncoderLimits encoder_limits(int workers) {
  EncoderLimits limits;
  limits.workers = workers > 0 ? size_t(workers) : std::max(1u, std::thread::hardware_concurrency());
  limits.frames = limits.workers + 2;
  constexpr uint64_t most_bytes = uint64_t(4) << 30;
  const long pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGE_SIZE);
  limits.bytes =
      pages > 0 && page_bytes > 0 ? std::min(most_bytes, uint64_t(pages) * uint64_t(page_bytes) / 4) : most_bytes;
  return limits;
}

}  // namespace candela
