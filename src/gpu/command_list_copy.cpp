#include "base/check.h"
#include "base/scratch.h"
#include "gpu/command_list_impl.h"
#include "gpu/image_copy.h"
#include "graph/access.h"
#include "graph/formats.h"

// The commands that move bytes without a shader.
namespace candela::gpu {

namespace {

VkImageSubresourceLayers layers_of_mip(const PhysicalImage& image, const ImageRange& range, uint32_t mip) {
  return {image.texels, mip, range.first_layer, range.layer_count};
}

VkOffset3D far_corner(const ImageDesc& desc, uint32_t mip) {
  const VkExtent3D extent = mip_extent(desc, mip);
  return {int32_t(extent.width), int32_t(extent.height), int32_t(extent.depth)};
}

bool same_extent(const VkExtent3D& a, const VkExtent3D& b) {
  return a.width == b.width && a.height == b.height && a.depth == b.depth;
}

}  // namespace

CommandListImpl::Part CommandListImpl::part(ImageHandle image, Access access, ImageRange range) const {
  CHECK_MSG(!rendering_, pass_.name);
  const PlanUse& use = use_of(image, {access}, range);
  const ImageDesc& desc = desc_of(image.resource);
  return {desc, frame_.image(image.resource), use.range, image_layout(access, desc.format)};
}

void CommandListImpl::copy_to_buffer(ImageHandle image, BufferHandle target, ImageRange range) {
  const Part from = part(image, Access::transfer_source, range);
  use_of(target, {Access::transfer_destination});
  CHECK_MSG(buffer(target.resource).size() >= range_bytes(from.desc, from.range), pass_.name);
  Scratch scratch;
  const ScratchVector<VkBufferImageCopy> regions = copy_regions(from.desc, from.image, from.range, &scratch);
  vkCmdCopyImageToBuffer(commands_, from.image.image, from.layout, buffer(target.resource).handle(),
                         uint32_t(regions.size()), regions.data());
}

void CommandListImpl::copy_part_to_buffer(ImageHandle image, BufferHandle target, const PixelRect& rect) {
  const Part from = part(image, Access::transfer_source, {});
  use_of(target, {Access::transfer_destination});
  CHECK_MSG(rect.end_x() <= int(from.desc.width_px) && rect.end_y() <= int(from.desc.height_px), pass_.name);
  CHECK_MSG(
      buffer(target.resource).size() >= uint64_t(rect.width) * uint64_t(rect.height) * format_bytes(from.desc.format),
      pass_.name);
  Scratch scratch;
  ScratchVector<VkBufferImageCopy> regions = copy_regions(from.desc, from.image, from.range, &scratch);
  CHECK_MSG(regions.size() == 1, pass_.name);
  regions[0].imageOffset = {rect.x, rect.y, 0};
  regions[0].imageExtent = {uint32_t(rect.width), uint32_t(rect.height), 1};
  vkCmdCopyImageToBuffer(commands_, from.image.image, from.layout, buffer(target.resource).handle(), 1, regions.data());
}

void CommandListImpl::copy_to_image(BufferHandle source, ImageHandle image, ImageRange range) {
  const Part to = part(image, Access::transfer_destination, range);
  use_of(source, {Access::transfer_source});
  CHECK_MSG(buffer(source.resource).size() >= range_bytes(to.desc, to.range), pass_.name);
  Scratch scratch;
  const ScratchVector<VkBufferImageCopy> regions = copy_regions(to.desc, to.image, to.range, &scratch);
  vkCmdCopyBufferToImage(commands_, buffer(source.resource).handle(), to.image.image, to.layout,
                         uint32_t(regions.size()), regions.data());
}

void CommandListImpl::copy_buffer(BufferHandle from, uint64_t from_offset, BufferHandle to, uint64_t to_offset,
                                  uint64_t bytes) {
  use_of(from, {Access::transfer_source});
  use_of(to, {Access::transfer_destination});
  CHECK_MSG(from_offset + bytes <= buffer(from.resource).size() && to_offset + bytes <= buffer(to.resource).size(),
            pass_.name);
  const VkBufferCopy region{from_offset, to_offset, bytes};
  vkCmdCopyBuffer(commands_, buffer(from.resource).handle(), buffer(to.resource).handle(), 1, &region);
}

void CommandListImpl::copy_image(ImageHandle from_image, ImageHandle to_image, ImageRange from_range,
                                 ImageRange to_range) {
  const Part from = part(from_image, Access::transfer_source, from_range);
  const Part to = part(to_image, Access::transfer_destination, to_range);
  CHECK_MSG(from.range.mip_count == to.range.mip_count && from.range.layer_count == to.range.layer_count &&
                format_bytes(from.desc.format) == format_bytes(to.desc.format),
            fmt::format("pass '{}' copies between parts of different shape", pass_.name));
  std::vector<VkImageCopy> regions;
  for (uint32_t i = 0; i < from.range.mip_count; ++i) {
    const uint32_t from_mip = from.range.first_mip + i, to_mip = to.range.first_mip + i;
    const VkExtent3D extent = mip_extent(from.desc, from_mip);
    CHECK_MSG(same_extent(extent, mip_extent(to.desc, to_mip)),
              fmt::format("pass '{}' copies between mips of different size", pass_.name));
    regions.push_back(
        {layers_of_mip(from.image, from.range, from_mip), {}, layers_of_mip(to.image, to.range, to_mip), {}, extent});
  }
  vkCmdCopyImage(commands_, from.image.image, from.layout, to.image.image, to.layout, uint32_t(regions.size()),
                 regions.data());
}

void CommandListImpl::copy_tile(ImageHandle from_image, const Tile& from_tile, ImageHandle to_image,
                                const Tile& to_tile, uint32_t size_px) {
  const Part from = part(from_image, Access::transfer_source, {}),
             to = part(to_image, Access::transfer_destination, {});
  const auto corner = [&](const Part& part, const Tile& tile) {
    CHECK_MSG(tile.layer < part.range.layer_count && tile.corner_px.x + size_px <= part.desc.width_px &&
                  tile.corner_px.y + size_px <= part.desc.height_px && part.range.mip_count == 1,
              pass_.name);
    return VkOffset3D{int32_t(tile.corner_px.x), int32_t(tile.corner_px.y), 0};
  };
  const auto layer = [&](const Part& part, const Tile& tile) {
    return VkImageSubresourceLayers{part.image.texels, part.range.first_mip, part.range.first_layer + tile.layer, 1};
  };
  const VkImageCopy region{
      layer(from, from_tile), corner(from, from_tile), layer(to, to_tile), corner(to, to_tile), {size_px, size_px, 1}};
  vkCmdCopyImage(commands_, from.image.image, from.layout, to.image.image, to.layout, 1, &region);
}

void CommandListImpl::blit(ImageHandle from_image, ImageHandle to_image, bool linear, ImageRange from_range,
                           ImageRange to_range) {
  const Part from = part(from_image, Access::transfer_source, from_range);
  const Part to = part(to_image, Access::transfer_destination, to_range);
  CHECK_MSG(from.range.mip_count == to.range.mip_count && from.range.layer_count == to.range.layer_count,
            fmt::format("pass '{}' blits between parts of different shape", pass_.name));
  std::vector<VkImageBlit> regions;
  for (uint32_t i = 0; i < from.range.mip_count; ++i) {
    const uint32_t from_mip = from.range.first_mip + i, to_mip = to.range.first_mip + i;
    regions.push_back({layers_of_mip(from.image, from.range, from_mip),
                       {{}, far_corner(from.desc, from_mip)},
                       layers_of_mip(to.image, to.range, to_mip),
                       {{}, far_corner(to.desc, to_mip)}});
  }
  vkCmdBlitImage(commands_, from.image.image, from.layout, to.image.image, to.layout, uint32_t(regions.size()),
                 regions.data(), linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST);
}

void CommandListImpl::fill_buffer(BufferHandle target, uint32_t value, uint64_t offset, uint64_t bytes) {
  CHECK_MSG(!rendering_, pass_.name);
  use_of(target, {Access::transfer_destination});
  vkCmdFillBuffer(commands_, buffer(target.resource).handle(), offset, bytes, value);
}

void CommandListImpl::clear_image(ImageHandle image, glm::vec4 value, ImageRange range) {
  const Part to = part(image, Access::transfer_destination, range);
  const VkImageSubresourceRange subresource = subresources(to.image, to.range);
  if (is_depth_format(to.desc.format)) {
    const VkClearDepthStencilValue clear{value.x, uint32_t(value.y)};
    vkCmdClearDepthStencilImage(commands_, to.image.image, to.layout, &clear, 1, &subresource);
    return;
  }
  VkClearColorValue clear{};
  for (int i = 0; i < 4; ++i) {
    if (is_integer_format(to.desc.format))
      clear.uint32[i] = uint32_t(int64_t(value[i]));
    else
      clear.float32[i] = value[i];
  }
  vkCmdClearColorImage(commands_, to.image.image, to.layout, &clear, 1, &subresource);
}

}  // namespace candela::gpu
