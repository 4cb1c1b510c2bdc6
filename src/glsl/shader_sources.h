#pragma once
#include <span>
#include <string_view>

namespace candela::glsl {
// A shader source file compiled into the binary; name is its path below shaders/.
struct EmbeddedShader {
  std::string_view name, text;
};
std::span<const EmbeddedShader> embedded_shaders();
}  // namespace candela::glsl
