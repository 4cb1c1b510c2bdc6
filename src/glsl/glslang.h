#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "glsl/shader_files.h"

namespace candela::glsl {

// How files of shaders end: ".vert", ".frag" and ".comp", and of pipelines of rays ".rgen", ".rahit", ".rchit" and
// ".rmiss".
bool is_shader_stage(std::string_view ending);

// One shader with what it includes, compiled by glslang, which the module candela_glslang.so holds; opened here at
// first use. stage: how its file ends; definitions: preprocessor lines. Errors (input): the shader's, with
// file and line of the including chain; there is no module, or it is of another build. Thread-safe.
Expected<std::vector<uint32_t>> compile_by_glslang(const ShaderFiles& files, const std::string& definitions,
                                                   const std::string& stage);

}  // namespace candela::glsl
