#include "render/shared_frames.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <new>

namespace candela {
namespace {

// State of a frame: one of these, or one more than the number of the worker that has it.
constexpr uint8_t is_free = 0, was_there = 254, is_rendered = 255;
static_assert(SharedFrames::most_workers < was_there);

}  // namespace

struct SharedFrames::Layout {
  std::atomic<uint8_t> state[1];  // as many as frames
  static size_t bytes(size_t frames) { return sizeof(Layout) - 1 + frames; }
};
static_assert(std::atomic<uint8_t>::is_always_lock_free);

Expected<std::unique_ptr<SharedFrames>> SharedFrames::create(size_t frames) {
  const int file = memfd_create("candela frames", MFD_CLOEXEC);
  std::unique_ptr<SharedFrames> shared(new SharedFrames(file, frames, 0));
  if (file < 0 || ftruncate(file, off_t(Layout::bytes(frames))) != 0)
    return fail(ErrorKind::out_of_memory, "--devices", "the list of frames cannot be shared: {}", std::strerror(errno));
  if (auto mapped = shared->map(); !mapped) return std::unexpected(mapped.error());
  return shared;
}

Expected<std::unique_ptr<SharedFrames>> SharedFrames::open(const std::string& text, size_t frames) {
  int file = -1;
  size_t worker = 0;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, file);
  const bool split = first.ec == std::errc{} && first.ptr != end && *first.ptr == ':';
  const auto second = split ? std::from_chars(first.ptr + 1, end, worker) : first;
  struct stat info {};
  if (!split || second.ec != std::errc{} || second.ptr != end || worker >= most_workers || file < 0 ||
      fstat(file, &info) != 0 || size_t(info.st_size) != Layout::bytes(frames))
    return fail(ErrorKind::usage, "--worker", "'{}' is not a list of {} frames that another process shares", text,
                frames);
  std::unique_ptr<SharedFrames> shared(new SharedFrames(file, frames, worker));
  if (auto mapped = shared->map(); !mapped) return std::unexpected(mapped.error());
  return shared;
}

Expected<void> SharedFrames::map() {
  void* memory = mmap(nullptr, Layout::bytes(frames_), PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0);
  if (memory == MAP_FAILED)
    return fail(ErrorKind::out_of_memory, "--devices", "the list of frames cannot be shared: {}", std::strerror(errno));
  shared_ = std::launder(reinterpret_cast<Layout*>(memory));  // zeroes, which are free frames
  return {};
}

SharedFrames::~SharedFrames() {
  if (shared_) munmap(shared_, Layout::bytes(frames_));
  if (file_ >= 0) close(file_);
}

bool SharedFrames::claim(size_t frame) {
  uint8_t expected = is_free;
  return shared_->state[frame].compare_exchange_strong(expected, uint8_t(worker_ + 1));
}

void SharedFrames::finish(size_t frame, bool rendered) { shared_->state[frame] = rendered ? is_rendered : was_there; }

SharedFrames::Counts SharedFrames::counts() const {
  Counts counts;
  for (size_t frame = 0; frame < frames_; ++frame) {
    const uint8_t state = shared_->state[frame];
    counts.free += state == is_free;
    counts.rendered += state == is_rendered;
    counts.skipped += state == was_there;
  }
  return counts;
}

void SharedFrames::release(size_t worker) {
  for (size_t frame = 0; frame < frames_; ++frame) {
    uint8_t expected = uint8_t(worker + 1);
    shared_->state[frame].compare_exchange_strong(expected, is_free);
  }
}

}  // namespace candela
