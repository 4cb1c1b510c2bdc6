#include "render/film_frames.h"

#include <algorithm>
#include <cstring>

#include "base/files.h"
#include "base/input.h"
#include "image/io.h"

namespace candela {
namespace fs = std::filesystem;
namespace {

fs::path kept_folder(const fs::path& film) { return film.string() + ".frames"; }

// A frame, or what is left of one that was being written when its run was killed.
bool is_kept_frame(const fs::path& file) {
  const std::string digits = file.stem().string();
  return file.extension() == ".png" &&
         (digits.starts_with(".candela-") ||
          (digits.size() >= 6 && std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; })));
}

// A file without alpha makes a film without.
void drop_alpha(DisplayImage& image) {
  const size_t sample = size_t(image.bits) / 8, count = size_t(image.width) * size_t(image.height);
  for (size_t i = 0; i < count; ++i)
    std::memmove(image.pixels.data() + i * 3 * sample, image.pixels.data() + i * 4 * sample, 3 * sample);
  image.channels = 3;
  image.pixels.resize(count * 3 * sample);
}

}  // namespace

int film_output(const std::vector<std::string>& outputs) {
  for (size_t i = 0; i < outputs.size(); ++i)
    if (const auto format = output_format(outputs[i]); format && *format == OutputFormat::png) return int(i);
  return -1;
}

FramePattern kept_frames(const fs::path& film) {
  using Piece = FramePattern::Piece;
  const std::string folder = kept_folder(film).string();
  return {.pieces = {Piece{.kind = Piece::Kind::text, .text = folder + "/"},
                     Piece{.kind = Piece::Kind::frame, .text = {}, .digits = 6},
                     Piece{.kind = Piece::Kind::text, .text = ".png"}},
          .given = folder,
          .numbered = true};
}

void remove_kept_frames(const fs::path& film) {
  const fs::path folder = kept_folder(film);
  std::error_code failed;
  std::vector<fs::path> frames;
  for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed))
    if (is_kept_frame(at->path())) frames.push_back(at->path());
  for (const fs::path& frame : frames) fs::remove(frame, failed);
  fs::remove(folder, failed);  // fails where something else is in it
}

Expected<DisplayImage> read_film_frame(const fs::path& file, int width_px, int height_px) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(bytes.error());
  auto decoded = decode_image(*bytes, file.string());
  if (!decoded) return std::unexpected(decoded.error());
  if (decoded->format == DecodedImage::Format::rgba32f)
    return fail(ErrorKind::input, file.string(), "is EXR, linear light; a film is made of PNG files");
  if (decoded->width != width_px || decoded->height != height_px)
    return fail(ErrorKind::input, file.string(), "is {}x{} and the film {}x{}", decoded->width, decoded->height,
                width_px, height_px);
  DisplayImage image{.width = decoded->width,
                     .height = decoded->height,
                     .channels = 4,
                     .bits = decoded->format == DecodedImage::Format::rgba8 ? 8 : 16,
                     .pixels = std::move(decoded->pixels)};
  if (decoded->source_channels == 1 || decoded->source_channels == 3) drop_alpha(image);
  return image;
}

}  // namespace candela
