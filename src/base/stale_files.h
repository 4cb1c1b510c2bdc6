#pragma once
#include <filesystem>

namespace candela {

// remove_stale_temporaries (files.h) of all targets, for a folder in which only candela writes.
void remove_all_stale_temporaries(const std::filesystem::path& folder);

}  // namespace candela
