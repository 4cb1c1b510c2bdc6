#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"

namespace candela {

// The content of all files read, in the order the loader names them, and of the sky's and the look's where there is
// one.
Expected<Hash128> hash_files(const std::vector<std::string>& files, const std::vector<std::string>& skies,
                             const std::string& look);

}  // namespace candela
