#include "glsl/glslang.h"

#include <dlfcn.h>

#include <cstring>
#include <map>
#include <set>

#include "base/modules.h"
#include "glsl/compiler_identity.h"
#include "glsl/modules/glslang_module.h"

namespace candela::glsl {
namespace {

constexpr const char* module_name = "candela_glslang.so";

struct Glslang {
  CandelaGlslCompile* compile = nullptr;
  std::string why;
};

const Glslang& opened_glslang() {
  static const Glslang glslang = [] {
    Glslang g;
    const Module module = open_module(module_name);
    if (!module.library) {
      g.why = module.reason;
      return g;
    }
    const auto identity = reinterpret_cast<CandelaGlslIdentity*>(dlsym(module.library, "candela_glsl_identity"));
    const auto compile = reinterpret_cast<CandelaGlslCompile*>(dlsym(module.library, "candela_glsl_compile"));
    if (identity && compile && std::strcmp(identity(), compiler_identity) == 0)
      g.compile = compile;
    else
      g.why = fmt::format("{} is of another version of candela", module_name);
    return g;
  }();
  return glslang;
}

// "ERROR: lib/brdf.glsl:12: 'x' : undeclared identifier" becomes place and message.
Error compile_error(const ShaderFiles& files, std::string_view log) {
  Error error{ErrorKind::input, {}, files.files[0].name};
  bool first = true;
  while (!log.empty()) {
    std::string_view line = log.substr(0, log.find('\n'));
    log.remove_prefix(std::min(log.size(), line.size() + 1));
    if (!line.starts_with("ERROR: ")) continue;
    line.remove_prefix(7);
    if (line.find("compilation errors") != std::string_view::npos) continue;
    const size_t colon = line.find(':');
    const size_t after = colon == std::string_view::npos ? colon : line.find(": ", colon + 1);
    if (!first || after == std::string_view::npos) {
      error.message += (error.message.empty() ? "" : "; ") + std::string(line);
      continue;
    }
    first = false;
    error.place = line.substr(0, after);
    error.message = line.substr(after + 2);
    const ShaderFile* file = files.find(std::string(line.substr(0, colon)));
    if (file && !file->included_by.empty()) error.place += ", included by " + file->included_by;
  }
  if (error.message.empty()) error.message = "does not compile, and the compiler gives no reason";
  return error;
}

// What one call of the module reads and writes. Exceptions may not cross the C interface.
struct Compilation {
  const ShaderFiles& files;
  std::set<const ShaderFile*> seen;
  std::vector<uint32_t> spirv;
  std::string log;
};

// Hands out the files that are loaded already. A second inclusion of a file with #pragma once is empty.
bool find_include(void* user, const char* include, const char* includer, CandelaGlslText* out) try {
  Compilation& c = *static_cast<Compilation*>(user);
  const ShaderFile* file = c.files.resolve(include, includer);
  if (!file) return false;
  const bool again = !c.seen.insert(file).second && file->once;
  *out = {file->name.c_str(), file->text.data(), again ? 0 : file->text.size()};
  return true;
} catch (const std::bad_alloc&) {
  return false;
}

void take_words(void* user, const uint32_t* words, size_t count) try {
  static_cast<Compilation*>(user)->spirv.assign(words, words + count);
} catch (const std::bad_alloc&) {
}

void take_log(void* user, const char* log) try {
  static_cast<Compilation*>(user)->log = log;
} catch (const std::bad_alloc&) {
}

const std::map<std::string_view, CandelaGlslStage>& stages() {
  static const std::map<std::string_view, CandelaGlslStage> map = {
      {".vert", candela_glsl_vertex}, {".frag", candela_glsl_fragment}, {".comp", candela_glsl_compute},
      {".rgen", candela_glsl_raygen}, {".rahit", candela_glsl_any_hit}, {".rchit", candela_glsl_closest_hit},
      {".rmiss", candela_glsl_miss},
  };
  return map;
}

}  // namespace

bool is_shader_stage(std::string_view ending) { return stages().contains(ending); }

Expected<std::vector<uint32_t>> compile_by_glslang(const ShaderFiles& files, const std::string& definitions,
                                                   const std::string& stage) {
  const Glslang& glslang = opened_glslang();
  const ShaderFile& root = files.files[0];
  if (!glslang.compile)
    return fail(
        ErrorKind::input, root.name,
        "this shader is not built into the program, and the module that compiles shaders cannot be opened ({}). "
        "Put {} of this version of candela there, or leave --shader-dir out",
        glslang.why, module_name);
  Compilation compilation{files, {}, {}, {}};
  const CandelaGlslRequest request{.stage = stages().at(stage),
                                   .definitions = definitions.c_str(),
                                   .root = {root.name.c_str(), root.text.data(), root.text.size()},
                                   .user = &compilation,
                                   .include = find_include,
                                   .done = take_words,
                                   .failed = take_log};
  glslang.compile(&request);
  if (compilation.spirv.empty()) return std::unexpected(compile_error(files, compilation.log));
  return std::move(compilation.spirv);
}

}  // namespace candela::glsl
