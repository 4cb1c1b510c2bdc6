// Included by C++ and GLSL alike: maps GLSL's types to GLM in namespace candela::shared. Scalar block layout on both
// sides, so the GLSL bytes are the C++ bytes and no padding members are needed. Rules: no bool; 64-bit members first.
#ifndef CANDELA_SHARED_TYPES_H
#define CANDELA_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#define SHARED_BEGIN namespace candela::shared {
#define SHARED_END }
#define SHARED_ENUM enum : uint32_t
namespace candela::shared {
using uint = uint32_t;
using vec2 = glm::vec2;
using vec3 = glm::vec3;
using vec4 = glm::vec4;
using dvec3 = glm::dvec3;
using uvec2 = glm::uvec2;
using uvec3 = glm::uvec3;
using uvec4 = glm::uvec4;
using mat4 = glm::mat4;
}  // namespace candela::shared
#else
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#define SHARED_BEGIN
#define SHARED_END
#endif

#endif
