#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela::cli {

// The files that -o names for one frame, in the order given. Errors (usage): a pattern or an ending that is none, a
// file that is named twice.
Expected<std::vector<std::filesystem::path>> output_paths(const std::vector<std::string>& outputs, int64_t frame);

}  // namespace candela::cli
