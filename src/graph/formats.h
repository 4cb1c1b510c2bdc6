#pragma once
#include <vulkan/vulkan_core.h>

#include <string_view>

namespace candela {

// "R16G16B16A16_SFLOAT". CHECKs like format_bytes on a format the project does not use.
std::string_view format_name(VkFormat format);
inline bool is_integer_format(VkFormat format) { return format_name(format).ends_with("INT"); }  // UINT, SINT

}  // namespace candela
