#pragma once
#include <filesystem>
#include <span>

#include "base/error.h"
#include "image/image.h"

// All file formats stop here. EXR goes through OpenEXR, PNG and JPEG in memory through stb, WebP through libwebp; HDR
// and KTX2 are decoded here and PNG output is written here; every other format goes through OpenImageIO, which lives in
// a module opened at first use.
namespace candela {

enum class ExrCompression { none, rle, zips, zip, piz, pxr24, b44, b44a, dwaa, dwab };
Expected<ExrCompression> exr_compression_from_name(std::string_view name);

// Atomic (temporary name, fsync, rename). Bytes depend on the image alone: no date, no host. Finite values beyond
// half's range are stored as its largest. Errors: output.
Expected<void> write_exr(const std::filesystem::path& path, const FloatImage& image,
                         ExrCompression compression = ExrCompression::zip);
// texts: keyword and text of tEXt chunks (png_text.h).
using PngText = std::pair<std::string, std::string>;
Expected<void> write_png(const std::filesystem::path& path, const DisplayImage& image,
                         const std::vector<PngText>& texts = {});

// Any format, to float; 8- and 16-bit files give code values / max in [0,1], not decoded. Errors: input, names the
// file.
Expected<FloatImage> read_image(const std::filesystem::path& path);

// A texture as the GPU takes it: RGBA, 8 or 16 bits a channel, float (HDR), or half floats (wide skies).
struct DecodedImage {
  int width = 0, height = 0;
  enum class Format { rgba8, rgba16, rgba32f, rgba16f } format = Format::rgba8;
  int source_channels = 4;  // channels the file had: 1 grey, 2 grey+alpha, 3, 4
  std::vector<std::byte> pixels;
};
enum class Transfer : uint8_t { unsaid, linear, srgb };
struct ImageInfo {
  int width = 0, height = 0, channels = 0, bits = 8;
  Transfer transfer = Transfer::unsaid;  // what a KTX2 file says of its colours
};
// Reads only the header. `place` names the image in errors. Images of more than 2^24 pixels are refused when they have
// more than 64 pixels for each byte of the file: a small file must not cost gigabytes. No photograph or painted texture
// comes near; a single colour does.
Expected<ImageInfo> probe_image(std::span<const std::byte> encoded, const std::string& place);
// PNG, JPEG, WebP, KTX2 (ETC1S, UASTC), (Radiance) HDR. Refuses what probe_image() refuses, sizes over max_side, and
// pixel counts that no file of this length could encode.
Expected<DecodedImage> decode_image(std::span<const std::byte> encoded, const std::string& place, int max_side = 16384);
// An environment as rgba32f: equirectangular (.hdr or .exr), or six faces (cube_faces.h). Non-finite and negative
// values become 0 with a warning; larger ones than 8192x4096 become means of their texels (sky_rows.h).
Expected<DecodedImage> read_environment(const std::filesystem::path& path);

}  // namespace candela
