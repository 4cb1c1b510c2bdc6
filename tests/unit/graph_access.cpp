#include <gtest/gtest.h>

#include "graph/access.h"
#include "graph/plan.h"

namespace candela {
namespace {

// Written down a second time from the Vulkan specification (sections on pipeline stages, access types, image layouts).
struct Row {
  Access access;
  const char* name;
  uint64_t stages, mask;
  VkImageLayout layout;
  uint32_t image_usage, buffer_usage;
  bool writes;
};
constexpr uint64_t vertex = 0x8, early = 0x100, late = 0x200, fragment = 0x80, color_output = 0x400, compute = 0x800,
                   transfer = 0x1000, host = 0x4000, indirect = 0x2, index_input = 0x1000000000, rays = 0x200000;
constexpr uint64_t indirect_read = 0x1, index_read = 0x2, uniform_r = 0x8, color_rw = 0x180, color_w = 0x100,
                   depth_r = 0x200, depth_rw = 0x600, transfer_r = 0x800, transfer_w = 0x1000, host_r = 0x2000,
                   sampled_r = 0x100000000, storage_r = 0x200000000, storage_rw = 0x600000000, storage_w = 0x400000000;
constexpr uint32_t address = 0x20000 | 0x20;  // SHADER_DEVICE_ADDRESS | STORAGE_BUFFER
const Row rows[] = {
    {Access::color_attachment, "color_attachment", color_output, color_rw, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
     0x10, 0, true},
    {Access::depth_attachment, "depth_attachment", early | late, depth_rw,
     VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, 0x20, 0, true},
    {Access::depth_test, "depth_test", early | late, depth_r, VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL, 0x20, 0,
     false},
    {Access::resolve_attachment, "resolve_attachment", color_output, color_w, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
     0x10, 0, true},
    {Access::sampled_fragment, "sampled_fragment", fragment, sampled_r, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 0x4,
     0, false},
    {Access::sampled_compute, "sampled_compute", compute, sampled_r, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 0x4, 0,
     false},
    {Access::storage_image_write, "storage_image_write", compute, storage_w, VK_IMAGE_LAYOUT_GENERAL, 0x8, 0, true},
    {Access::storage_image_read_write, "storage_image_read_write", compute, storage_rw, VK_IMAGE_LAYOUT_GENERAL, 0x8, 0,
     true},
    {Access::transfer_source, "transfer_source", transfer, transfer_r, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, 0x1, 0x1,
     false},
    {Access::transfer_destination, "transfer_destination", transfer, transfer_w, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
     0x2, 0x2, true},
    {Access::vertex_read, "vertex_read", vertex, storage_r, VK_IMAGE_LAYOUT_UNDEFINED, 0, address, false},
    {Access::fragment_read, "fragment_read", fragment, storage_r, VK_IMAGE_LAYOUT_UNDEFINED, 0, address, false},
    {Access::graphics_read, "graphics_read", vertex | fragment, storage_r, VK_IMAGE_LAYOUT_UNDEFINED, 0, address,
     false},
    {Access::uniform_read, "uniform_read", vertex | fragment | compute, uniform_r, VK_IMAGE_LAYOUT_UNDEFINED, 0, 0x10,
     false},
    {Access::compute_read, "compute_read", compute, storage_r, VK_IMAGE_LAYOUT_UNDEFINED, 0, address, false},
    {Access::compute_write, "compute_write", compute, storage_rw, VK_IMAGE_LAYOUT_UNDEFINED, 0, address, true},
    {Access::fragment_write, "fragment_write", fragment, storage_rw, VK_IMAGE_LAYOUT_UNDEFINED, 0, address, true},
    {Access::index_read, "index_read", index_input, index_read, VK_IMAGE_LAYOUT_UNDEFINED, 0, 0x40, false},
    {Access::indirect_read, "indirect_read", indirect, indirect_read, VK_IMAGE_LAYOUT_UNDEFINED, 0, 0x100, false},
    {Access::host_read, "host_read", host, host_r, VK_IMAGE_LAYOUT_UNDEFINED, 0, 0, false},
    {Access::storage_image_read, "storage_image_read", compute, storage_r, VK_IMAGE_LAYOUT_GENERAL, 0x8, 0, false},
    {Access::sampled_graphics, "sampled_graphics", vertex | fragment, sampled_r,
     VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 0x4, 0, false},
    {Access::rays_read, "rays_read", rays, storage_r, VK_IMAGE_LAYOUT_UNDEFINED, 0, address, false},
    {Access::rays_write, "rays_write", rays, storage_rw, VK_IMAGE_LAYOUT_UNDEFINED, 0, address, true},
};

TEST(GraphAccess, TableAgainstAWrittenOne) {
  ASSERT_EQ(std::size(rows), size_t(access_count));
  for (int i = 0; i < access_count; ++i) {
    const Row& row = rows[i];
    SCOPED_TRACE(row.name);
    ASSERT_EQ(int(row.access), i);
    const AccessInfo& info = access_info(row.access);
    EXPECT_EQ(info.name, row.name);
    EXPECT_EQ(info.stages, row.stages);
    EXPECT_EQ(info.mask, row.mask);
    EXPECT_EQ(info.layout, row.layout);
    EXPECT_EQ(info.image_usage, row.image_usage);
    EXPECT_EQ(info.buffer_usage, row.buffer_usage);
    EXPECT_EQ(info.writes, row.writes);
  }
}

TEST(GraphAccess, DepthIsSampledInTheLayoutItIsTestedIn) {
  for (const Access sampled : {Access::sampled_fragment, Access::sampled_compute, Access::sampled_graphics}) {
    EXPECT_EQ(image_layout(sampled, VK_FORMAT_D32_SFLOAT), image_layout(Access::depth_test, VK_FORMAT_D32_SFLOAT));
    EXPECT_EQ(image_layout(sampled, VK_FORMAT_R8_UNORM), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  }
}

TEST(GraphAccess, FormatSizes) {
  EXPECT_EQ(format_bytes(VK_FORMAT_R16G16B16A16_SFLOAT), 8u);
  EXPECT_EQ(format_bytes(VK_FORMAT_D32_SFLOAT), 4u);
  EXPECT_DEATH(format_bytes(VK_FORMAT_ASTC_4x4_UNORM_BLOCK), "not in the table");
}

}  // namespace
}  // namespace candela
