#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "session/session.h"

namespace candela {

// Pictures of a frame's images as passes leave them, for `render --steps`.
struct StepPicture {
  std::string pass, image;    // of the plan
  std::string part;           // "mip 2, layer 1"; empty: the image has one
  std::string file;           // name in the folder
  std::string shows;          // how values became colours
  int width = 0, height = 0;  // of the file
};

// Writes a PNG for each dump of the frame into the folder. Light goes through the job's exposure and tone curve, depth
// of the picture is in metres with a scale, single values are in a colour map with one, ids in a colour each.
Expected<std::vector<StepPicture>> write_step_pictures(const FrameResult& frame, const Job& job,
                                                       const std::filesystem::path& folder);

}  // namespace candela
