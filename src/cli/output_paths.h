#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela::cli {

// The files that -o names for one frame, of one camera where there are several, in the order given. Errors (usage): a
// pattern or an ending that is none, a file that is named twice.
Expected<std::vector<std::filesystem::path>> output_paths(const std::vector<std::string>& outputs, int64_t frame,
                                                          const std::string& camera = {});

// The folder of the first output, where what shows why a frame did not end in time is left; the present one where its
// name has places for numbers.
std::string folder_of_outputs(const std::vector<std::string>& outputs);

}  // namespace candela::cli
