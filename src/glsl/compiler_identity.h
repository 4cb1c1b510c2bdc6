#pragma once
#include <glslang/build_info.h>

// Everything about the compiler that changes its output: part of every key, and what the program and the module
// candela_glslang.so must agree on. The last number is that of the module's interface.
#define CANDELA_GLSL_TEXT_OF(x) #x
#define CANDELA_GLSL_TEXT(x) CANDELA_GLSL_TEXT_OF(x)
namespace candela::glsl {
inline constexpr const char* compiler_identity = "glslang " CANDELA_GLSL_TEXT(
    GLSLANG_VERSION_MAJOR) "." CANDELA_GLSL_TEXT(GLSLANG_VERSION_MINOR) "." CANDELA_GLSL_TEXT(GLSLANG_VERSION_PATCH)
    GLSLANG_VERSION_FLAVOR " vulkan 1.3 spirv 1.6 module 1";
}
#undef CANDELA_GLSL_TEXT
#undef CANDELA_GLSL_TEXT_OF
