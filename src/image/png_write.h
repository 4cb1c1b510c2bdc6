#pragma once
#include <cstddef>
#include <vector>

#include "base/error.h"
#include "image/image.h"

namespace candela {

// The file's bytes: sRGB marked, no date, no program name, the same for the same pixels. `place` names the file in the
// error (output).
Expected<std::vector<std::byte>> encode_png(const DisplayImage& image, const std::string& place);

}  // namespace candela
