#include "farm/film.h"

#include "base/file_uses.h"
#include "base/files.h"
#include "job/picture_window.h"
#include "render/film_frames.h"
#include "render/video.h"

namespace candela {
namespace fs = std::filesystem;

Expected<void> make_farm_film(const FarmJob& job) {
  const int output = film_output(job.outputs);
  if (output < 0) return fail(ErrorKind::input, farm_job_file(job.folder).string(), "a film needs frames as PNG");
  const fs::path film = job.work / job.video, audio = job.audio.empty() ? fs::path() : job.work / job.audio;
  if (!audio.empty()) note_read({"--audio", audio});
  const NamedFile output_file{"--video", film};
  if (auto fine = declare_outputs(std::span(&output_file, 1)); !fine) return fine;
  const PixelRect data = picture_window(job.job).data;
  std::unique_ptr<VideoWriter> video;
  for (const int64_t frame : job.frame_list()) {
    const auto image = read_film_frame(job.files(frame)[size_t(output)], data.width, data.height);
    if (!image) return std::unexpected(image.error());
    if (!video) {
      auto opened =
          VideoWriter::open({film, audio, job.video_codec, job.video_pad}, image->width, image->height, job.rate());
      if (!opened) return std::unexpected(opened.error());
      video = std::move(*opened);
    }
    if (auto added = video->add(*image); !added) return added;
  }
  return video->finish();
}

}  // namespace candela
