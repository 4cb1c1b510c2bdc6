#include "graph/access.h"

#include <array>

#include "base/check.h"

namespace candela {
namespace {

// Buffers reach shaders by their address.
constexpr VkBufferUsageFlags addressed = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
constexpr VkPipelineStageFlags2 depth_tests =
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;
constexpr VkPipelineStageFlags2 vertex_and_fragment =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
constexpr VkAccessFlags2 storage_read = VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
constexpr VkAccessFlags2 storage_write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
constexpr VkImageLayout none = VK_IMAGE_LAYOUT_UNDEFINED;

// In the order of the enum. The depth layouts are the combined ones: valid for a format without stencil, and they need
// no separateDepthStencilLayouts.
constexpr std::array<AccessInfo, access_count> table{{
    {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
     VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
     VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0, true, "color_attachment"},
    {depth_tests, VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
     VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, 0, true,
     "depth_attachment"},
    {depth_tests, VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL,
     VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, 0, false, "depth_test"},
    {VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT,
     VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0, true, "resolve_attachment"},
    {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
     VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_USAGE_SAMPLED_BIT, 0, false, "sampled_fragment"},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
     VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_IMAGE_USAGE_SAMPLED_BIT, 0, false, "sampled_compute"},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, storage_write, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_USAGE_STORAGE_BIT, 0,
     true, "storage_image_write"},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, storage_read | storage_write, VK_IMAGE_LAYOUT_GENERAL,
     VK_IMAGE_USAGE_STORAGE_BIT, 0, true, "storage_image_read_write"},
    {VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
     VK_IMAGE_USAGE_TRANSFER_SRC_BIT, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, false, "transfer_source"},
    {VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
     VK_IMAGE_USAGE_TRANSFER_DST_BIT, VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, "transfer_destination"},
    {VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT, storage_read, none, 0, addressed, false, "vertex_read"},
    {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, storage_read, none, 0, addressed, false, "fragment_read"},
    {vertex_and_fragment, storage_read, none, 0, addressed, false, "graphics_read"},
    {vertex_and_fragment | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_UNIFORM_READ_BIT, none, 0,
     VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, false, "uniform_read"},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, storage_read, none, 0, addressed, false, "compute_read"},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, storage_read | storage_write, none, 0, addressed, true, "compute_write"},
    {VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, storage_read | storage_write, none, 0, addressed, true, "fragment_write"},
    {VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT, none, 0, VK_BUFFER_USAGE_INDEX_BUFFER_BIT, false,
     "index_read"},
    {VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT, none, 0,
     VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT, false, "indirect_read"},
    {VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, none, 0, 0, false, "host_read"},
    {VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, storage_read, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_USAGE_STORAGE_BIT, 0,
     false, "storage_image_read"},
    {vertex_and_fragment, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
     VK_IMAGE_USAGE_SAMPLED_BIT, 0, false, "sampled_graphics"},
    {VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, storage_read, none, 0, addressed, false, "rays_read"},
    {VK_PIPELINE_STAGE_2_RAY_TRACING_SHADER_BIT_KHR, storage_read | storage_write, none, 0, addressed, true,
     "rays_write"},
}};

}  // namespace

const AccessInfo& access_info(Access access) {
  CHECK(size_t(access) < table.size());
  return table[size_t(access)];
}

bool is_sampled(Access access) {
  return access == Access::sampled_fragment || access == Access::sampled_compute || access == Access::sampled_graphics;
}

bool is_depth_format(VkFormat format) {
  return format >= VK_FORMAT_D16_UNORM && format <= VK_FORMAT_D32_SFLOAT_S8_UINT;
}

bool has_stencil(VkFormat format) { return format >= VK_FORMAT_S8_UINT && format <= VK_FORMAT_D32_SFLOAT_S8_UINT; }

VkImageLayout image_layout(Access access, VkFormat format) {
  if (is_sampled(access) && is_depth_format(format)) return VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL;
  return access_info(access).layout;
}

}  // namespace candela
