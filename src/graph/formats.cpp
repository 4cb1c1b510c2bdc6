#include "graph/formats.h"

#include "base/check.h"
#include "graph/plan.h"

namespace candela {
namespace {

struct FormatInfo {
  VkFormat format;
  std::string_view name;
  uint32_t bytes;
};

constexpr FormatInfo formats[] = {
    {VK_FORMAT_R8_UNORM, "R8_UNORM", 1},
    {VK_FORMAT_R8_SNORM, "R8_SNORM", 1},
    {VK_FORMAT_R8_UINT, "R8_UINT", 1},
    {VK_FORMAT_R8G8_UNORM, "R8G8_UNORM", 2},
    {VK_FORMAT_R8G8_SNORM, "R8G8_SNORM", 2},
    {VK_FORMAT_R8G8_UINT, "R8G8_UINT", 2},
    {VK_FORMAT_R8G8B8A8_UNORM, "R8G8B8A8_UNORM", 4},
    {VK_FORMAT_R8G8B8A8_SNORM, "R8G8B8A8_SNORM", 4},
    {VK_FORMAT_R8G8B8A8_UINT, "R8G8B8A8_UINT", 4},
    {VK_FORMAT_R8G8B8A8_SRGB, "R8G8B8A8_SRGB", 4},
    {VK_FORMAT_B8G8R8A8_UNORM, "B8G8R8A8_UNORM", 4},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, "A2B10G10R10_UNORM", 4},
    {VK_FORMAT_B10G11R11_UFLOAT_PACK32, "B10G11R11_UFLOAT", 4},
    {VK_FORMAT_E5B9G9R9_UFLOAT_PACK32, "E5B9G9R9_UFLOAT", 4},
    {VK_FORMAT_R16_UNORM, "R16_UNORM", 2},
    {VK_FORMAT_R16_SNORM, "R16_SNORM", 2},
    {VK_FORMAT_R16_UINT, "R16_UINT", 2},
    {VK_FORMAT_R16_SFLOAT, "R16_SFLOAT", 2},
    {VK_FORMAT_R16G16_UNORM, "R16G16_UNORM", 4},
    {VK_FORMAT_R16G16_SNORM, "R16G16_SNORM", 4},
    {VK_FORMAT_R16G16_UINT, "R16G16_UINT", 4},
    {VK_FORMAT_R16G16_SFLOAT, "R16G16_SFLOAT", 4},
    {VK_FORMAT_R16G16B16A16_UNORM, "R16G16B16A16_UNORM", 8},
    {VK_FORMAT_R16G16B16A16_SNORM, "R16G16B16A16_SNORM", 8},
    {VK_FORMAT_R16G16B16A16_UINT, "R16G16B16A16_UINT", 8},
    {VK_FORMAT_R16G16B16A16_SFLOAT, "R16G16B16A16_SFLOAT", 8},
    {VK_FORMAT_R32_UINT, "R32_UINT", 4},
    {VK_FORMAT_R32_SINT, "R32_SINT", 4},
    {VK_FORMAT_R32_SFLOAT, "R32_SFLOAT", 4},
    {VK_FORMAT_R32G32_UINT, "R32G32_UINT", 8},
    {VK_FORMAT_R32G32_SFLOAT, "R32G32_SFLOAT", 8},
    {VK_FORMAT_R32G32B32A32_UINT, "R32G32B32A32_UINT", 16},
    {VK_FORMAT_R32G32B32A32_SFLOAT, "R32G32B32A32_SFLOAT", 16},
    {VK_FORMAT_D16_UNORM, "D16_UNORM", 2},
    {VK_FORMAT_D32_SFLOAT, "D32_SFLOAT", 4},
    {VK_FORMAT_D32_SFLOAT_S8_UINT, "D32_SFLOAT_S8_UINT", 5},  // copies move its depth alone: 4
};

const FormatInfo& format_info(VkFormat format) {
  for (const FormatInfo& info : formats)
    if (info.format == format) return info;
  CHECK_MSG(false, fmt::format("format {} is not in the table", int(format)));
}

}  // namespace

std::string_view format_name(VkFormat format) { return format_info(format).name; }
uint32_t format_bytes(VkFormat format) { return format_info(format).bytes; }
uint32_t copied_bytes(VkFormat format) { return has_stencil(format) ? 4 : format_bytes(format); }
uint32_t format_channels(VkFormat format) {
  const std::string_view name = format_name(format);
  const std::string_view layout = is_depth_format(format) ? "D" : name.substr(0, name.find('_'));
  return uint32_t(std::count_if(layout.begin(), layout.end(), [](char c) { return c >= 'A' && c <= 'Z' && c != 'E'; }));
}

}  // namespace candela
