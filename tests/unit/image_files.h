#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/files.h"

namespace candela {
// The bytes of a file of tests/images; none where it cannot be read.
inline std::vector<std::byte> file_of(const std::string& name) {
  auto bytes = read_file(std::filesystem::path(CANDELA_SOURCE_DIR) / "tests/images" / name);
  return bytes ? *bytes : std::vector<std::byte>();
}
}  // namespace candela
