#include "cli/output_paths.h"

#include <algorithm>

#include "render/frame_names.h"

namespace candela::cli {

Expected<std::vector<std::filesystem::path>> output_paths(const std::vector<std::string>& outputs, int64_t frame,
                                                          const std::string& camera) {
  std::vector<std::filesystem::path> paths;
  for (const std::string& text : outputs) {
    const auto pattern = parse_pattern(text);
    if (!pattern) return std::unexpected(pattern.error());
    if (pattern->by_camera && camera.empty())
      return fail(ErrorKind::usage, "-o", "'{}': {{camera}} goes with --camera all", text);
    std::filesystem::path path = pattern->name(frame, camera);
    if (const auto format = output_format(path); !format) return std::unexpected(format.error());
    if (std::find(paths.begin(), paths.end(), path) != paths.end())
      return fail(ErrorKind::usage, "-o", "'{}' is named twice", path.string());
    paths.push_back(std::move(path));
  }
  return paths;
}

std::string folder_of_outputs(const std::vector<std::string>& outputs) {
  const std::string folder = outputs.empty() ? "" : std::filesystem::path(outputs.front()).parent_path().string();
  return folder.empty() || folder.find_first_of("%#{$") != folder.npos ? "." : folder;
}

}  // namespace candela::cli
