#pragma once
#include <string>

namespace candela {

// Libraries that few jobs need lie in modules of their own (docs/building/decisions.md): candela_glslang.so,
// candela_oiio.so, candela_draco.so, candela_demoscenes.so. They are looked for beside the program, as in a build
// folder, then in ../lib/candela, as installed: relative to the program, so that an installation may be moved.
struct Module {
  void* library = nullptr;  // for dlsym; never closed, because other threads may be inside
  std::string reason;       // why there is none
};
Module open_module(const std::string& name);

}  // namespace candela
