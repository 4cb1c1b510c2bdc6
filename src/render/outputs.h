#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "image/image.h"
#include "session/session.h"

namespace candela {

// Non-finite pixels of a frame: how many, the first one (x, y, layer).
struct NonFinite {
  uint64_t count = 0;
  int x = 0, y = 0;
  std::string layer;
  uint64_t clamped = 0;  // finite values beyond half, which a file of halves holds as its largest
};

// The frame as a linear image with all layers and metadata (camera matrices, frame, fps, job, plan hash, device,
// version; timings on request). Pre-exposure is removed. frame: absent when the job was given a time.
FloatImage linear_image(const FrameResult& frame, const Job& job, const Session& session,
                        std::optional<int64_t> frame_number, FrameRate rate, NonFinite& nonfinite);
DisplayImage display_image(const FrameResult& frame, const Job& job);  // straight alpha

// Where a frame file says which picture it holds: EXR attribute and PNG text chunk of this name.
inline constexpr const char* identity_name = "candela:identity";
// Of the job, the scene's content, device, version, time, frame number and rate, as 32 hex digits.
std::string file_identity(const Job& job, const Session& session, double time_s, std::optional<int64_t> frame_number,
                          FrameRate rate);
// The same for frames that another machine rendered: its device, and scene_content as hex digits.
std::string file_identity(const Job& job, const std::string& scene_content, const std::string& device,
                          const std::string& driver, double time_s, std::optional<int64_t> frame_number,
                          FrameRate rate);
// True when the file says that it holds that picture, and its bytes are those that were written (image/seal.h). False
// for a missing file.
bool holds_frame(const std::filesystem::path& path, const std::string& identity);
// By the header and the length of a file. damaged: it exists, but is not whole or holds another picture.
enum class FileState { missing, damaged, whole };
FileState header_state(const std::filesystem::path& path, const std::string& identity);

// Writes one finished frame to every path (the ending chooses EXR or PNG), each atomically; fills timings with
// read_back and encode.
Expected<void> write_outputs(FrameResult& frame, const Job& job, const Session& session,
                             std::optional<int64_t> frame_number, FrameRate rate,
                             const std::vector<std::filesystem::path>& paths);

}  // namespace candela
