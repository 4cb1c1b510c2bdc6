#include "image/oiio.h"

#include <dlfcn.h>

#include "base/modules.h"

namespace candela {
namespace {

struct Opened {
  const oiio::Table* table = nullptr;
  std::string reason;
};

Opened open_table() {
  const Module module = open_module("candela_oiio.so");
  if (!module.library) return {nullptr, module.reason};
  const auto* table = static_cast<const oiio::Table*>(dlsym(module.library, oiio::table_symbol));
  if (table && table->version == oiio::abi_version) return {table, {}};
  return {nullptr, "candela_oiio.so is of another version of candela"};
}

}  // namespace

Expected<const oiio::Table*> open_oiio(const std::string& place) {
  static const Opened opened = open_table();
  if (opened.table) return opened.table;
  return fail(
      ErrorKind::input, place,
      "this picture is neither EXR, PNG, JPEG, WebP, KTX2 nor HDR: other formats need the module candela_oiio.so, "
      "which this "
      "installation lacks or cannot open. Convert the picture to one of those, or install the Debian package of "
      "candela with libopenimageio2.4 ({})",
      opened.reason);
}

}  // namespace candela
