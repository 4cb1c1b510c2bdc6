#include "base/modules.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <filesystem>

#include "base/files.h"

namespace candela {

Module open_module(const std::string& name) {
  const std::filesystem::path folder = program_folder();
  for (const auto& path : {folder / name, folder / "../lib/candela" / name}) {
    std::error_code failed;
    if (!std::filesystem::exists(path, failed)) continue;
    if (void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return {library, {}};
    const char* reason = dlerror();
    return {nullptr, reason ? reason : path.string() + " cannot be opened"};
  }
  return {nullptr, fmt::format("there is no {} beside the program or in ../lib/candela", name)};
}

}  // namespace candela
