#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "image/io.h"

namespace candela {

// read_environment() with its warnings as text instead of log lines.
Expected<DecodedImage> read_environment(const std::filesystem::path& path, std::vector<std::string>& warnings);

}  // namespace candela
