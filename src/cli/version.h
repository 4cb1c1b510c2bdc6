#pragma once
#include "base/error.h"

namespace candela::cli {

// candela --version: one line, or as JSON what was built in and which modules can be opened.
Expected<int> print_version(bool json);

}  // namespace candela::cli
