#include "cli/version.h"

#include <nlohmann/json.hpp>

#include "base/modules.h"
#include "cli/build_info.h"
#include "cli/command.h"
#include "glsl/built_in_spirv.h"

namespace candela::cli {
namespace {

nlohmann::ordered_json module_json(const char* file) {
  const Module module = open_module(file);
  return {{"opens", module.library != nullptr}, {"reason", module.reason}};
}

nlohmann::ordered_json version_json() {
  nlohmann::ordered_json libraries = nlohmann::ordered_json::object();
  for (const auto& [name, version] : build_info.libraries) libraries[name] = version;
  return {{"program", "candela"},
          {"version", CANDELA_VERSION},
          {"source", source_version},
          {"build",
           {{"type", build_info.type},
            {"compiler", build_info.compiler},
            {"processor", build_info.processor},
            {"libraries_linked", build_info.libraries_linked},
            {"sanitizers", build_info.sanitizers},
            {"deliberate_faults", build_info.deliberate_faults}}},
          {"libraries", libraries},
          {"modules",
           {{"candela_glslang.so", module_json("candela_glslang.so")},
            {"candela_oiio.so", module_json("candela_oiio.so")},
            {"candela_draco.so", module_json("candela_draco.so")},
            {"candela_demoscenes.so", module_json("candela_demoscenes.so")}}},
          {"shaders", {{"sources", "built in"}, {"spirv_built_in", !glsl::built_in_spirv().empty()}}}};
}

}  // namespace

Expected<int> print_version(bool json) {
  std::string line = std::string("candela ") + CANDELA_VERSION;
  if (*source_version) line += std::string(" (") + source_version + ")";
  const auto printed = json ? print_json(version_json()) : print(line + "\n");
  if (!printed) return std::unexpected(printed.error());
  return 0;
}

}  // namespace candela::cli
