#pragma once
#include "base/error.h"

namespace candela {

// What the exception that is being handled means, whatever it is.
Error current_error();

}  // namespace candela
