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

// Whether files being encoded or decoded have threads of their own beside the one that asks; else that one alone. At
// the start they have. Returns what it was. Not while a file is encoded or decoded.
bool set_file_threads(bool own);

}  // namespace candela
