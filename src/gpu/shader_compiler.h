#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"

namespace candela::gpu {

// GLSL to SPIR-V by glslang as a library. Sources are embedded; a shader folder replaces them (--shader-dir, watch).
// The result is cached on disk under a hash of everything that went in: the source with all its includes, the stage,
// the compiler's version. A damaged cache file is made again. Thread-safe.
class ShaderCompiler {
 public:
  explicit ShaderCompiler(std::filesystem::path shader_folder = {},
                          std::filesystem::path cache = {});  // empty: embedded, no cache
  struct Result {
    std::vector<uint32_t> spirv;
    bool from_cache = false;
    std::vector<std::string> files;  // the source and what it includes
  };
  // file: below shaders/, with definitions after it ("layers.frag#DEPTH=0"). Errors (input): names file and line of the
  // including chain.
  Expected<Result> compile(const std::string& name) const;

 private:
  std::filesystem::path shader_folder_, cache_;
};

}  // namespace candela::gpu
