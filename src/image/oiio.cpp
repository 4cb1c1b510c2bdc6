#include "image/oiio.h"

#include <dlfcn.h>

#include "base/files.h"

namespace candela {
namespace {

struct Module {
  const oiio::Table* table = nullptr;
  std::string reason;
};

// Beside the program in a build folder, in ../lib/candela when installed. Never closed: its libraries do not expect to
// be.
Module load_module() {
  const std::filesystem::path folder = program_folder();
  Module module;
  for (const auto& path : {folder / "candela_oiio.so", folder / "../lib/candela/candela_oiio.so"}) {
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) {
      if (module.reason.empty() || std::filesystem::exists(path)) module.reason = dlerror();
      continue;
    }
    module.table = static_cast<const oiio::Table*>(dlsym(library, oiio::table_symbol));
    if (module.table && module.table->version == oiio::abi_version) return module;
    module.table = nullptr;
    module.reason = path.string() + " is of another version of candela";
  }
  return module;
}

}  // namespace

Expected<const oiio::Table*> open_oiio(const std::string& place) {
  static const Module module = load_module();
  if (module.table) return module.table;
  return fail(
      ErrorKind::input, place,
      "this file format needs the module candela_oiio.so beside the program: install libopenimageio-dev and build with "
      "CANDELA_OIIO=ON, or use EXR or PNG ({})",
      module.reason);
}

}  // namespace candela
