#include "gpu/frame_hash.h"

#include <cstring>
#include <set>

#include "base/scratch.h"
#include "gpu/image_copy.h"
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

void change_layout(VkCommandBuffer commands, const PhysicalImage& image, const ImageRange& range, VkImageLayout from,
                   VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.srcAccessMask = barrier.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.image;
  barrier.subresourceRange = subresources(image, range);
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace

uint64_t count_nonfinite(VkFormat format, std::span<const std::byte> bytes) {
  const std::string_view name = format_name(format);
  if (!name.ends_with("SFLOAT")) return 0;
  return name.find("16") != std::string_view::npos ? count_full_exponents<uint16_t>(bytes, 0x7c00)
                                                   : count_full_exponents<uint32_t>(bytes, 0x7f800000);
}

namespace {
// The layout that a pass leaves one subresource in: its last step that uses it decides.
VkImageLayout layout_after(const PlanPass& pass, const ImageDesc& desc, int resource, const ImageRange& one) {
  int last = -1;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED;
  for (const PlanUse& use : pass.uses) {
    const int step = use.step == PlanUse::every_step ? int(pass.steps()) - 1 : use.step;
    if (use.resource != resource || step < last || !use.range.overlaps(one)) continue;
    last = step;
    layout = image_layout(use.access, desc.format);
  }
  return layout;
}
}  // namespace

void OutputHasher::record_image(const FrameContext& frame, const PlanPass& pass, const PlanUse& use,
                                VkCommandBuffer commands) {
  const auto& desc = std::get<ImageDesc>(frame.plan.resources[size_t(use.resource)].desc);
  const PhysicalImage& image = frame.image(use.resource);
  const VkImageLayout read =
      desc.samples > 1 ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL : VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
  const auto change_all = [&](bool to_read) {
    for_subresources(use.range, desc.layers, [&](size_t subresource) {
      const ImageRange one{uint32_t(subresource) / desc.layers, 1, uint32_t(subresource) % desc.layers, 1};
      const VkImageLayout own = layout_after(pass, desc, use.resource, one);
      change_layout(commands, image, one, to_read ? own : read, to_read ? read : own);
    });
  };
  change_all(true);
  if (desc.samples > 1) {
    samples_.record(commands, desc, frame.view(view_key(use)), staging_.address());
  } else {
    Scratch scratch;
    const ScratchVector<VkBufferImageCopy> regions = copy_regions(desc, image, use.range, &scratch);
    vkCmdCopyImageToBuffer(commands, image.image, read, staging_.handle(), uint32_t(regions.size()), regions.data());
  }
  change_all(false);
}

void OutputHasher::copy_and_wait(const FrameContext& frame, const PlanPass& pass, const PlanUse& use, QueueWork& work,
                                 uint64_t bytes) {
  constexpr VkBufferUsageFlags usage =
      VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
  if (staging_.size() < bytes)
    staging_ =
        Buffer(frame.device, bytes, usage, Buffer::Memory::host_read, Device::Purpose::readback, "hashed output");
  VkCommandBuffer commands = work.begin();
  full_barrier(commands);
  if (frame.plan.resources[size_t(use.resource)].is_image()) {
    record_image(frame, pass, use, commands);
  } else {
    const VkBufferCopy region{0, 0, bytes};
    vkCmdCopyBuffer(commands, frame.buffers[size_t(use.resource)]->handle(), staging_.handle(), 1, &region);
  }
  VkMemoryBarrier2 to_host{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  to_host.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
  to_host.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  to_host.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  to_host.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &to_host;
  vkCmdPipelineBarrier2(commands, &info);
  work.submit();
  if (!work.wait(copy_timeout_s)) throw GpuError(VK_TIMEOUT, "copying what a pass wrote");
  staging_.invalidate();
}

void OutputHasher::hash_outputs(const FrameContext& frame, size_t pass, QueueWork& work,
                                std::vector<PassHash>& hashes) {
  const PlanPass& planned = frame.plan.passes[pass];
  std::set<std::pair<int, ImageRange>> seen;  // several steps may write the same
  for (const PlanUse& use : planned.uses) {
    if (!use.writes || !seen.emplace(use.resource, use.range).second) continue;
    const PlanResource& resource = frame.plan.resources[size_t(use.resource)];
    const auto* image = std::get_if<ImageDesc>(&resource.desc);
    PassHash hash{planned.name, resource.name() + (image ? range_text(use.range, *image) : ""), {}, 0};
    const bool multisampled = image && image->samples > 1;
    if (multisampled && (!frame.image(use.resource).sampled || has_stencil(image->format))) {
      hash.resource += " (multisampled, not hashed)";
      hashes.push_back(std::move(hash));
      continue;
    }
    if (const auto* buffer = std::get_if<BufferDesc>(&resource.desc); buffer && buffer->unordered) {
      hash.resource += " (unordered scratch, not hashed)";
      hashes.push_back(std::move(hash));
      continue;
    }
    uint64_t bytes = 0;
    if (multisampled)
      bytes = SampleReader::bytes(*image);
    else if (image)
      bytes = range_bytes(*image, use.range);
    else
      bytes = frame.buffers[size_t(use.resource)]->size();
    copy_and_wait(frame, planned, use, work, bytes);
    const std::span<const std::byte> contents(staging_.mapped(), bytes);
    hash.hash = hash128(contents);
    // Samples are read as 32-bit floats, whatever their format.
    const bool widened = multisampled && format_name(image->format).ends_with("FLOAT");
    if (image) hash.nonfinite = count_nonfinite(widened ? VK_FORMAT_R32_SFLOAT : image->format, contents);
    hashes.push_back(std::move(hash));
  }
}

}  // namespace candela::gpu
