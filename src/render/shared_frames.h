#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "base/error.h"

namespace candela {

// One list of frames that several processes render: each takes the next free one. It lies in memory that
// they share through an open file, so that a process that dies takes nothing with it but the frames in its hands, and
// those are known.
class SharedFrames {
 public:
  static constexpr size_t most_workers = 64;

  static Expected<std::unique_ptr<SharedFrames>> create(size_t frames);
  // What "FILE:WORKER" of a parent names: the number of an open file, and which worker this process is.
  static Expected<std::unique_ptr<SharedFrames>> open(const std::string& text, size_t frames);
  ~SharedFrames();
  SharedFrames(const SharedFrames&) = delete;
  SharedFrames& operator=(const SharedFrames&) = delete;

  int file() const { return file_; }
  // For the worker: true where the frame (by its place in the list) is now its own; its files are there.
  bool claim(size_t frame);
  void finish(size_t frame, bool rendered);

  // For the parent.
  struct Counts {
    size_t rendered = 0, skipped = 0, free = 0;
    size_t done() const { return rendered + skipped; }
  };
  Counts counts() const;
  void release(size_t worker);  // what a worker that is gone had taken and not finished is free again

 private:
  struct Layout;
  SharedFrames(int file, size_t frames, size_t worker) : file_(file), frames_(frames), worker_(worker) {}
  Expected<void> map();
  int file_ = -1;
  size_t frames_ = 0, worker_ = 0;
  Layout* shared_ = nullptr;
};

}  // namespace candela
