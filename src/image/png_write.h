#pragma once
#include <cstddef>
#include <vector>

#include "base/check.h"
#include "base/error.h"
#include "image/image.h"

namespace candela {

// The file's bytes: sRGB marked, no date, no program name, the same for the same pixels. `place` names the file in the
// error (output).
Expected<std::vector<std::byte>> encode_png(const DisplayView& image, const std::string& place);
inline Expected<std::vector<std::byte>> encode_png(const DisplayImage& image, const std::string& place) {
  CHECK(image.pixels.size() == row_bytes(image) * size_t(image.height));
  return encode_png(view_of(image), place);
}

}  // namespace candela
