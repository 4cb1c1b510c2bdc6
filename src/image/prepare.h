#pragma once
#include "base/prepared_file.h"
#include "image/io.h"

namespace candela {

// write_exr and write_png without their last step, the rename.
Expected<PreparedFile> prepare_exr(const std::filesystem::path& path, const FloatImage& image,
                                   ExrCompression compression);
Expected<PreparedFile> prepare_exr(const std::filesystem::path& path, const PictureView& image,
                                   ExrCompression compression);
Expected<PreparedFile> prepare_png(const std::filesystem::path& path, const DisplayView& image,
                                   const std::vector<PngText>& texts);

// Threads that all EXR files being encoded or decoded share; 0: each file has the thread that asks for it alone.
// Returns how many there were. At the start as many as there are cores, at most 8. Not while a file is encoded or
// decoded.
int set_exr_threads(int threads);

}  // namespace candela
