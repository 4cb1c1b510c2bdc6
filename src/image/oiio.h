#pragma once
#include "base/error.h"
#include "image/modules/oiio_abi.h"

namespace candela {

// The module candela_oiio.so, opened at the first call and kept; `place` names the file that needs it in the error.
Expected<const oiio::Table*> open_oiio(const std::string& place);

}  // namespace candela
