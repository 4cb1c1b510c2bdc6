#pragma once
#include <string>

#include "image/image.h"

namespace Imf_3_1 {
class Header;
}

namespace candela {

// A whole file of lines with ZIP (blocks of 16 lines) or ZIPS (of one) compression, as OpenEXR's own writer lays it out
// ("OpenEXR File Layout"; the container is simple). What OpenEXR's reader gives back is what is in the planes. The
// header says the channels, which are those of the planes, and the compression. Bytes do not depend on the number of
// threads.
std::string encode_exr_zip(const Imf_3_1::Header& header, const PictureView& image, int lines_a_block);

}  // namespace candela
