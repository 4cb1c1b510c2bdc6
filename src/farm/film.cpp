#include "farm/film.h"

#include "base/file_uses.h"
#include "base/files.h"
#include "image/io.h"
#include "render/video.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

Expected<DisplayImage> read_frame(const fs::path& file) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  auto decoded = decode_image(*bytes, file.string());
  if (!decoded) return std::unexpected(decoded.error());
  if (decoded->format != DecodedImage::Format::rgba8)
    return fail(ErrorKind::input, file.string(), "has more than 8 bits a channel, which a film has not");
  return DisplayImage{.width = decoded->width,
                      .height = decoded->height,
                      .channels = 4,
                      .bits = 8,
                      .pixels = std::move(decoded->pixels)};
}

}  // namespace

int film_output(const std::vector<std::string>& outputs) {
  for (size_t i = 0; i < outputs.size(); ++i)
    if (const auto format = output_format(outputs[i]); format && *format == OutputFormat::png) return int(i);
  return -1;
}

Expected<void> make_farm_film(const FarmJob& job) {
  const int output = film_output(job.outputs);
  if (output < 0) return fail(ErrorKind::input, farm_job_file(job.folder).string(), "a film needs frames as PNG");
  const fs::path film = job.work / job.video, audio = job.audio.empty() ? fs::path() : job.work / job.audio;
  if (!audio.empty()) note_read({"--audio", audio});
  const NamedFile output_file{"--video", film};
  if (auto fine = declare_outputs(std::span(&output_file, 1)); !fine) return fine;
  std::unique_ptr<VideoWriter> video;
  for (const int64_t frame : job.frame_list()) {
    const fs::path file = job.files(frame)[size_t(output)];
    const auto image = read_frame(file);
    if (!image) return std::unexpected(image.error());
    if (image->width != job.job.width_px || image->height != job.job.height_px)
      return fail(ErrorKind::input, file.string(), "is {}x{} and the film {}x{}", image->width, image->height,
                  job.job.width_px, job.job.height_px);
    if (!video) {
      auto opened = VideoWriter::open(film, audio, image->width, image->height, job.rate());
      if (!opened) return std::unexpected(opened.error());
      video = std::move(*opened);
    }
    if (auto added = video->add(*image); !added) return added;
  }
  return video->finish();
}

}  // namespace candela
