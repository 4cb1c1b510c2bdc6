#pragma once
#include <filesystem>
#include <memory>

#include "base/prepared_file.h"
#include "image/image.h"
#include "job/job.h"
#include "render/film_format.h"

namespace candela {

// Frames to a film through the program ffmpeg: raw RGB or RGBA over a pipe, by the codec asked for with Rec.709
// colours, optional audio. The film has a temporary name until finish(); without finish() nothing is left.
class VideoWriter {
 public:
  // Errors: no ffmpeg on PATH (usage), no audio file (input), codec, ending or size (usage).
  static Expected<std::unique_ptr<VideoWriter>> open(const FilmFile& film, int width_px, int height_px, FrameRate rate);
  ~VideoWriter();
  // The first says whether the film has alpha and how many bits, as far as its codec can. Without alpha the picture
  // stands on black, and a warning says so once.
  Expected<void> add(const DisplayImage& image);
  // After at least one frame.
  Expected<void> finish();

 private:
  Expected<void> start(const DisplayImage& first);
  void say_that_alpha_is_lost(const DisplayImage& image);
  Expected<void> wait_for_exit();
  VideoWriter(PreparedFile file, FilmFile film, const FilmCodec& codec, int width_px, int height_px, FrameRate rate)
      : file_(std::move(file)),
        film_(std::move(film)),
        codec_(codec),
        width_px_(width_px),
        height_px_(height_px),
        rate_(rate) {}
  PreparedFile file_;
  FilmFile film_;
  const FilmCodec& codec_;
  int width_px_, height_px_, bits_ = 8;
  FrameRate rate_;
  bool alpha_ = false, said_ = false;
  int pipe_ = -1, process_ = -1;
};
Expected<void> check_video(const FilmFile& film);

}  // namespace candela
