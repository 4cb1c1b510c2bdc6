#pragma once
#include <string>

namespace candela::gpu {

// Why there is no driver, and what to do. Loaders report a driver that fails as one that is not there, so it is looked
// whether files name one.
std::string no_driver();

}  // namespace candela::gpu
