#pragma once
#include <span>
#include <string>

#include "base/error.h"
#include "image/io.h"

// OpenEXR in memory; files are read and written whole around it, so that a full disk is seen by our own write and
// close.
namespace candela {

inline constexpr int max_exr_side = 65536;

bool is_exr(std::span<const std::byte> bytes);
Expected<std::string> encode_exr(const FloatImage& image, ExrCompression compression, const std::string& place);
Expected<std::string> encode_exr(const PictureView& image, ExrCompression compression, const std::string& place);
void set_exr_threads(bool own);  // set_file_threads for OpenEXR, which has threads that all files share
void start_exr_threads();        // once, before files are read or written by them
// Size, bits 32, and the number of channels of the first flat part. Reads only the heads.
Expected<ImageInfo> probe_exr(std::span<const std::byte> bytes, const std::string& place);
// Every flat part whose data window is the first part's; channels of later parts carry the part's name as layer.
// `whole`: bytes after the last block of pixels are an error (of files that have no other parts).
Expected<FloatImage> decode_exr(std::span<const std::byte> bytes, const std::string& place, bool whole = false);

}  // namespace candela
