#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "image/image.h"
#include "render/frame_names.h"

namespace candela {

// Pictures that a film is made of: PNG files of 8 or 16 bits a channel, with alpha or without.

// Which of the outputs a film can be made of; -1: none.
int film_output(const std::vector<std::string>& outputs);

// Where the frames of a film lie until it is made, when none of its run's outputs is a PNG: FILM.frames/000007.png.
FramePattern kept_frames(const std::filesystem::path& film);
// Takes away what kept_frames() names, of any run, and the folder unless something else is in it.
void remove_kept_frames(const std::filesystem::path& film);

// Errors (input): not there, damaged, no PNG, another size.
Expected<DisplayImage> read_film_frame(const std::filesystem::path& file, int width_px, int height_px);

}  // namespace candela
