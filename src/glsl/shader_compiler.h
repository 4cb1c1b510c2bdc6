#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"

namespace candela::glsl {

// GLSL to SPIR-V. Sources are embedded; a shader folder replaces them (--shader-dir, watch). A result is known by the
// hash of everything that went in: the source with all its includes, the definitions, the stage, the compiler's
// version. It comes from the table of what is built in, else from the cache on disk, else from glslang, whose module is
// opened at first need. A damaged cache file is made again. Thread-safe.
class ShaderCompiler {
 public:
  // Empty: embedded sources, no cache, nothing built in. The table (glsl/built_in_spirv.h) must outlive the compiler.
  explicit ShaderCompiler(std::filesystem::path shader_folder = {}, std::filesystem::path cache = {},
                          std::span<const std::byte> built_in = {});
  struct Result {
    std::vector<uint32_t> spirv;
    bool built_in = false, from_cache = false;
    std::vector<std::string> files;  // the source and what it includes
    Hash128 key;
  };
  // file: below shaders/, with definitions after it ("layers.frag#DEPTH=0"). Errors (input): names file and line of the
  // including chain; the module is missing.
  Expected<Result> compile(const std::string& name) const;

 private:
  std::filesystem::path shader_folder_, cache_;
  std::span<const std::byte> built_in_;
};

}  // namespace candela::glsl
