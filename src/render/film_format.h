#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace candela {

// A film as it is asked for.
struct FilmFile {
  std::filesystem::path path, audio;  // empty: none
  std::string codec = "auto";         // film_codec_names(); auto: by the ending of the name
  bool pad = false;                   // sides that the codec does not take grow by a black row or column
};

// How the pictures of a film are stored.
struct FilmCodec {
  std::string_view name;
  std::string_view title;                 // as messages say it
  std::vector<std::string_view> endings;  // of files that hold it
  bool even_sides = false;                // 4:2:0 chroma, which H.264 and H.265 give no half sample of
  bool deep = false;                      // takes more than 8 bits a channel
  bool deep_by_default = false;           // and always has them
  bool alpha = false;                     // straight (not premultiplied), as PNG has it
  std::string_view audio;                 // codec of its sound
};
std::vector<std::string> film_codec_names();  // with auto
// Errors (usage): an unknown codec, or one that the file's ending does not hold.
Expected<const FilmCodec*> film_codec(const FilmFile& film);
// Error (usage) that names sizes which work, where the codec takes none like this and nothing is to be added.
Expected<void> check_film_size(const FilmFile& film, int width_px, int height_px);

// Options of ffmpeg's output: filters, encoder, colours and container.
std::vector<std::string> encoder_arguments(const FilmCodec& codec, const FilmFile& film, int bits, bool alpha);

}  // namespace candela
