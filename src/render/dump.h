#pragma once
#include <filesystem>
#include <span>

#include "image/image.h"
#include "session/session.h"

namespace candela {

// What `render --dump` writes (docs/using/outputs.md): the values as they are in the image, without conversion of
// exposure or colour. Channels R G B A by the format's own, Y of a single one, Z of depth; integers as 32-bit ones
// (signed: as floats), halves as halves, all else as 32-bit floats. Of a multisampled image the first sample.
FloatImage dump_image(const FrameDump& dump, std::span<const std::byte> bytes);

// Writes each dump of the frame to its path, atomically.
Expected<void> write_dumps(const FrameResult& frame, const Job& job, const Session& session,
                           const std::vector<std::filesystem::path>& paths);

}  // namespace candela
