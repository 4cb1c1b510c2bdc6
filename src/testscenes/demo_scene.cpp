#include "testscenes/demo_scene.h"

#include <dlfcn.h>

#include "base/modules.h"

namespace candela {
namespace {

struct Maker {
  CandelaMakeDemoScene* make = nullptr;
  std::string reason;  // why there is none
};

const Maker& maker() {
  static const Maker maker = [] {
    Maker m;
    const Module module = open_module("candela_demoscenes.so");
    if (module.library)
      m.make = reinterpret_cast<CandelaMakeDemoScene*>(dlsym(module.library, "candela_make_demo_scene"));
    if (!m.make) m.reason = module.library ? "candela_demoscenes.so is of another version of candela" : module.reason;
    return m;
  }();
  return maker;
}

int take(void* user, const void* bytes, size_t size) try {
  const std::byte* from = static_cast<const std::byte*>(bytes);
  static_cast<std::vector<std::byte>*>(user)->assign(from, from + size);
  return 0;
} catch (...) {
  return 1;
}

}  // namespace

Expected<std::vector<std::byte>> make_demo_scene(const std::string& name, CandelaDemoScenePart part, uint64_t seed,
                                                 int lights) {
  if (!maker().make)
    return fail(ErrorKind::usage, "", "the scene '{}' needs a module that cannot be opened: {}", name, maker().reason);
  std::vector<std::byte> bytes;
  if (const char* wrong = maker().make(name.c_str(), part, seed, lights, take, &bytes))
    return fail(ErrorKind::usage, "", "the scene '{}' cannot be made: {}", name, wrong);
  return bytes;
}

}  // namespace candela
