#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "image/io.h"

namespace candela {

// read_environment() with its warnings as text instead of log lines. before_bytes: what its scene takes decoded
// already; the environment and its mips are charged on top (base/input.h).
Expected<DecodedImage> read_environment(const std::filesystem::path& path, std::vector<std::string>& warnings,
                                        uint64_t before_bytes = 0);

// What an image takes as a DecodedImage: four channels of 1, 2 or 4 bytes.
uint64_t decoded_bytes(const ImageInfo& info);
// The same with its mips, which are a third more at most.
inline uint64_t decoded_bytes_with_mips(const ImageInfo& info) { return decoded_bytes(info) / 3 * 4; }

}  // namespace candela
