#pragma once
#include <vulkan/vulkan_core.h>

#include <string_view>

namespace candela {

// "R16G16B16A16_SFLOAT". CHECKs like format_bytes on a format the project does not use.
std::string_view format_name(VkFormat format);
// "R16G16_SFLOAT" has two, "D32_SFLOAT" one, and so has depth with stencil: shaders and copies reach its depth alone.
uint32_t format_channels(VkFormat format);
uint32_t copied_bytes(VkFormat format);  // of a texel in a buffer
inline bool is_integer_format(VkFormat format) { return format_name(format).ends_with("INT"); }  // UINT, SINT

}  // namespace candela
