#include "gpu/frame_hash.h"

#include <cstring>

#include "gpu/timing.h"
#include "graph/access.h"
#include "graph/formats.h"

namespace candela::gpu {

namespace {

constexpr double copy_timeout_s = 600;

template <class Word>
uint64_t count_full_exponents(std::span<const std::byte> bytes, Word exponent) {
  uint64_t count = 0;
  for (size_t at = 0; at + sizeof(Word) <= bytes.size(); at += sizeof(Word)) {
    Word word;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    count += (word & exponent) == exponent;
  }
  return count;
}

void change_layout(VkCommandBuffer commands, const PhysicalImage& image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image;
  barrier.subresourceRange = {image.aspect, 0, 1, 0, 1};
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

void copy_and_wait(const FrameContext& frame, const PlanUse& use, QueueWork& work, Buffer& staging, uint64_t bytes) {
  if (staging.size() < bytes)
    staging = Buffer(frame.device, bytes, VK_BUFFER_USAGE_TRANSFER_DST_BIT, Buffer::Memory::host_read,
                     Device::Purpose::readback, "hashed output");
  const PlanResource& resource = frame.plan.resources[size_t(use.resource)];
  VkCommandBuffer commands = work.begin();
  full_barrier(commands);
  if (const auto* desc = std::get_if<ImageDesc>(&resource.desc)) {
    const PhysicalImage& image = frame.physical.image(use.resource);
    const VkImageLayout layout = image_layout(use.access, desc->format);
    change_layout(commands, image, layout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    VkBufferImageCopy region{};
    region.imageSubresource = {image.aspect, 0, 0, 1};
    region.imageExtent = {desc->width_px, desc->height_px, 1};
    vkCmdCopyImageToBuffer(commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.handle(), 1, &region);
    change_layout(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, layout);
  } else {
    const VkBufferCopy region{0, 0, bytes};
    vkCmdCopyBuffer(commands, frame.buffers[size_t(use.resource)]->handle(), staging.handle(), 1, &region);
  }
  VkMemoryBarrier2 to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  to_host.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  to_host.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  to_host.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  to_host.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &to_host;
  vkCmdPipelineBarrier2(commands, &info);
  work.submit();
  if (!work.wait(copy_timeout_s)) throw GpuError(VK_TIMEOUT, "copying what a pass wrote");
  staging.invalidate();
}

}  // namespace

uint64_t count_nonfinite(VkFormat format, std::span<const std::byte> bytes) {
  const std::string_view name = format_name(format);
  if (!name.ends_with("SFLOAT")) return 0;
  return name.find("16") != std::string_view::npos ? count_full_exponents<uint16_t>(bytes, 0x7c00)
                                                   : count_full_exponents<uint32_t>(bytes, 0x7f800000);
}

void hash_outputs(const FrameContext& frame, size_t pass, QueueWork& work, Buffer& staging,
                  std::vector<PassHash>& hashes) {
  for (const PlanUse& use : frame.plan.passes[pass].uses) {
    if (!use.writes) continue;
    const PlanResource& resource = frame.plan.resources[size_t(use.resource)];
    PassHash hash{frame.plan.passes[pass].name, resource.name(), {}, 0};
    const auto* image = std::get_if<ImageDesc>(&resource.desc);
    if (image && image->samples > 1) {
      hash.resource += " (multisampled, not hashed)";
      hashes.push_back(std::move(hash));
      continue;
    }
    const uint64_t bytes = image ? uint64_t(image->width_px) * image->height_px * format_bytes(image->format)
                                 : frame.buffers[size_t(use.resource)]->size();
    copy_and_wait(frame, use, work, staging, bytes);
    const std::span<const std::byte> contents(staging.mapped(), bytes);
    hash.hash = hash128(contents);
    if (image) hash.nonfinite = count_nonfinite(image->format, contents);
    hashes.push_back(std::move(hash));
  }
}

}  // namespace candela::gpu
