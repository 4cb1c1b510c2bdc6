#pragma once
#include "base/prepared_file.h"
#include "render/outputs.h"

namespace candela {

// Files of one frame that are whole on disk and not yet in place, and, where it was wanted, the picture for the screen.
struct PreparedOutputs {
  std::vector<PreparedFile> files;
  DisplayImage display;
};
// write_outputs without its last step, which puts the files in place.
Expected<PreparedOutputs> prepare_outputs(FrameResult& frame, const Job& job, const Session& session,
                                          std::optional<int64_t> frame_number, FrameRate rate,
                                          const std::vector<std::filesystem::path>& paths, bool display_wanted = false);

}  // namespace candela
