#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "image/image.h"

namespace candela {

// Rows [first, last) of a picture as PNG stores them before compression, appended nowhere: into `out`, which has
// (1 + bytes of a row) for each. A row has the filter whose differences have the least sum (PNG specification, third
// edition, 12.7).
void filter_png_rows(const DisplayView& image, int first, int last, std::byte* out);

}  // namespace candela
