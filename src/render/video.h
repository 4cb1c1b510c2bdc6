#pragma once
#include <filesystem>
#include <memory>

#include "base/prepared_file.h"
#include "image/image.h"
#include "job/job.h"

namespace candela {

// Frames to a film through the program ffmpeg: raw RGB over a pipe, H.264 with Rec.709 colours, quality 18, optional
// audio. The film has a temporary name until finish(); without finish() nothing is left.
class VideoWriter {
 public:
  // Errors: no ffmpeg on PATH (usage), no audio file (input), an ending other than .mp4, .mov or .mkv (usage).
  static Expected<std::unique_ptr<VideoWriter>> open(const std::filesystem::path& path,
                                                     const std::filesystem::path& audio, int width_px, int height_px,
                                                     FrameRate rate);
  ~VideoWriter();
  // 8 bits; alpha shows black, as a film has nothing behind it.
  Expected<void> add(const DisplayImage& image);
  Expected<void> finish();

 private:
  Expected<void> wait_for_exit();
  explicit VideoWriter(PreparedFile film) : film_(std::move(film)) {}
  std::filesystem::path path_;
  PreparedFile film_;
  int pipe_ = -1, process_ = -1;
};
Expected<void> check_video(const std::filesystem::path& path, const std::filesystem::path& audio);

}  // namespace candela
