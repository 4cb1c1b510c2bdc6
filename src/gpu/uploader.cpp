#include <sys/mman.h>
#include <unistd.h>

#include <cstring>

#include "base/check.h"
#include "gpu/resources.h"

namespace candela::gpu {

namespace {

// Height of a block of texels: 4 for the block-compressed formats, which are the ones between BC1 and ASTC in the enum.
uint32_t block_height(VkFormat format) {
  return format >= VK_FORMAT_BC1_RGB_UNORM_BLOCK && format <= VK_FORMAT_EAC_R11G11_SNORM_BLOCK ? 4 : 1;
}

void texture_barrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  const bool first = from == VK_IMAGE_LAYOUT_UNDEFINED;
  barrier.srcStageMask = first ? VK_PIPELINE_STAGE_2_NONE : VK_PIPELINE_STAGE_2_COPY_BIT;
  barrier.srcAccessMask = first ? VK_ACCESS_2_NONE : VK_ACCESS_2_TRANSFER_WRITE_BIT;
  barrier.dstStageMask = first ? VK_PIPELINE_STAGE_2_COPY_BIT : VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  barrier.dstAccessMask = first ? VK_ACCESS_2_TRANSFER_WRITE_BIT : VK_ACCESS_2_SHADER_SAMPLED_READ_BIT;
  barrier.oldLayout = from;
  barrier.newLayout = to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0, 1};
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace

struct Uploader::Hidden {
  Device& device;
  const uint64_t staging_bytes;
  Buffer staging;
  uint64_t used = 0;
  VkCommandPool pool = VK_NULL_HANDLE;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkFence fence = VK_NULL_HANDLE;
  bool recording = false, submitted = false;

  Hidden(Device& d, uint64_t bytes)
      : device(d),
        staging_bytes(bytes),
        staging(d, staging_bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, Buffer::Memory::upload, Device::Purpose::staging,
                "upload staging") {
    VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool_info.queueFamilyIndex = device.queue_family();
    VK_CHECK(vkCreateCommandPool(device.handle(), &pool_info, nullptr, &pool));
    VkCommandBufferAllocateInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    info.commandPool = pool;
    info.commandBufferCount = 1;
    VK_CHECK(vkAllocateCommandBuffers(device.handle(), &info, &commands));
    VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    VK_CHECK(vkCreateFence(device.handle(), &fence_info, nullptr, &fence));
    device.set_name(VK_OBJECT_TYPE_COMMAND_BUFFER, uint64_t(commands), "upload");
  }
  ~Hidden() {
    if (submitted) vkWaitForFences(device.handle(), 1, &fence, VK_TRUE, UINT64_MAX);
    vkDestroyFence(device.handle(), fence, nullptr);
    vkDestroyCommandPool(device.handle(), pool, nullptr);
  }

  void begin() {
    if (recording) return;
    CHECK(!submitted);
    VK_CHECK(vkResetCommandPool(device.handle(), pool, 0));
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    VK_CHECK(vkBeginCommandBuffer(commands, &info));
    recording = true;
  }

  void submit() {
    if (!recording) return;
    // Everything uploaded is visible to whatever the queue does later.
    VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
    memory.srcStageMask = VK_PIPELINE_STAGE_2_COPY_BIT;
    memory.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
    memory.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
    memory.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
    VkDependencyInfo dependency{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &memory;
    vkCmdPipelineBarrier2(commands, &dependency);
    VK_CHECK(vkEndCommandBuffer(commands));
    VkCommandBufferSubmitInfo buffer{VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO, nullptr, commands};
    VkSubmitInfo2 submit{VK_STRUCTURE_TYPE_SUBMIT_INFO_2};
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &buffer;
    VK_CHECK(vkQueueSubmit2(device.queue(), 1, &submit, fence));
    recording = false;
    submitted = true;
  }

  void submit_and_wait() {
    submit();
    wait();
  }

  void wait() {
    if (!submitted) return;
    VK_CHECK(vkWaitForFences(device.handle(), 1, &fence, VK_TRUE, UINT64_MAX));
    VK_CHECK(vkResetFences(device.handle(), 1, &fence));
    submitted = false;
    used = 0;
  }

  // Room for at least `least` bytes in the staging buffer, at its offset `used`; submits what is there when it is full.
  uint64_t room(uint64_t least) {
    used = (used + 15) & ~15ull;  // copies into images start at multiples of the texel block size
    if (staging_bytes < used + least) submit_and_wait();
    begin();
    return staging_bytes - used;
  }

  using Level = std::span<const std::byte>;
  template <class Copied>
  void copy_level(Texture& target, const TextureData& shape, uint32_t level, Level bytes, Copied copied);
  template <class Copied>  // copied(bytes, count): the first bytes of a level have been copied
  void copy_levels(Texture& target, const TextureData& shape, std::span<const Level> levels, Copied copied);
};

Uploader::Uploader(Device& device, uint64_t staging_bytes) : hidden_(std::make_unique<Hidden>(device, staging_bytes)) {}
Uploader::~Uploader() = default;

void Uploader::to_buffer(Buffer& target, uint64_t offset, std::span<const std::byte> bytes) {
  CHECK(offset + bytes.size() <= target.size());
  hidden_->device.count_uploaded(bytes.size());
  if (target.mapped()) {
    if (!bytes.empty()) std::memcpy(target.mapped() + offset, bytes.data(), bytes.size());
    return;
  }
  for (size_t done = 0; done < bytes.size();) {
    const uint64_t part = std::min<uint64_t>(hidden_->room(16), bytes.size() - done);
    std::memcpy(hidden_->staging.mapped() + hidden_->used, bytes.data() + done, part);
    const VkBufferCopy region{hidden_->used, offset + done, part};
    vkCmdCopyBuffer(hidden_->commands, hidden_->staging.handle(), target.handle(), 1, &region);
    hidden_->used += part;
    done += part;
  }
}

template <class Copied>
void Uploader::Hidden::copy_level(Texture& target, const TextureData& shape, uint32_t level, Level bytes,
                                  Copied copied) {
  const uint32_t block = block_height(shape.format);
  const uint32_t width = std::max(1u, shape.width >> level), height = std::max(1u, shape.height >> level);
  const uint32_t rows = (height + block - 1) / block;
  CHECK(!bytes.empty() && bytes.size() % rows == 0);
  const uint64_t row_bytes = bytes.size() / rows;
  CHECK(row_bytes <= staging_bytes);
  device.count_uploaded(bytes.size());
  for (uint32_t row = 0; row < rows;) {
    const uint32_t part = uint32_t(std::min<uint64_t>(room(row_bytes) / row_bytes, rows - row));
    std::memcpy(staging.mapped() + used, bytes.data() + row * row_bytes, part * row_bytes);
    VkBufferImageCopy region{};
    region.bufferOffset = used;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
    region.imageOffset = {0, int32_t(row * block), 0};
    region.imageExtent = {width, std::min(part * block, height - row * block), 1};
    vkCmdCopyBufferToImage(commands, staging.handle(), target.image(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &region);
    used += part * row_bytes;
    row += part;
    copied(bytes.data(), row * row_bytes);
  }
}

template <class Copied>
void Uploader::Hidden::copy_levels(Texture& target, const TextureData& shape, std::span<const Level> levels,
                                   Copied copied) {
  begin();
  texture_barrier(commands, target.image(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  for (uint32_t level = 0; level < levels.size(); ++level) copy_level(target, shape, level, levels[level], copied);
  begin();
  texture_barrier(commands, target.image(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
}

namespace {
std::vector<std::span<const std::byte>> levels_of(const TextureData& data) {
  return {data.levels.begin(), data.levels.end()};
}
// The pages of what has been copied, for a device that shares the memory fills the texture's meanwhile. They read as
// zeros from then on.
void give_back(const std::byte* bytes, size_t done) {
  const uint64_t page = uint64_t(sysconf(_SC_PAGESIZE));
  const auto first = (reinterpret_cast<uintptr_t>(bytes) + page - 1) / page * page,
             end = (reinterpret_cast<uintptr_t>(bytes) + done) / page * page;
  if (end > first) madvise(reinterpret_cast<void*>(first), end - first, MADV_DONTNEED);
}
}  // namespace

void Uploader::to_texture(Texture& target, const TextureData& data) {
  hidden_->copy_levels(target, data, levels_of(data), [](const std::byte*, size_t) {});
}
void Uploader::to_texture(Texture& target, TextureData&& data) {
  hidden_->copy_levels(target, data, levels_of(data), give_back);
  data.levels.clear();
}
void Uploader::to_texture(Texture& target, const TextureData& shape, std::vector<float>&& texels) {
  const std::span<const std::byte> level = std::as_bytes(std::span(texels));
  hidden_->copy_levels(target, shape, std::span(&level, 1), give_back);
  texels = {};
}

std::span<std::byte> Uploader::texture_room(Texture& target, VkFormat format, uint32_t width, uint32_t height,
                                            uint32_t levels, uint32_t texel_bytes) {
  Hidden& hidden = *hidden_;
  CHECK(block_height(format) == 1);
  const auto side = [](uint32_t of_first, uint32_t level) { return std::max(1u, of_first >> level); };
  uint64_t bytes = 0;
  for (uint32_t level = 0; level < levels; ++level)
    bytes += uint64_t(side(width, level)) * side(height, level) * texel_bytes;
  CHECK(bytes <= hidden.room(bytes));
  hidden.device.count_uploaded(bytes);
  const std::span<std::byte> room(hidden.staging.mapped() + hidden.used, bytes);
  texture_barrier(hidden.commands, target.image(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
  for (uint32_t level = 0; level < levels; ++level) {
    VkBufferImageCopy region{};
    region.bufferOffset = hidden.used;
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
    region.imageExtent = {side(width, level), side(height, level), 1};
    vkCmdCopyBufferToImage(hidden.commands, hidden.staging.handle(), target.image(),
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    hidden.used += uint64_t(region.imageExtent.width) * region.imageExtent.height * texel_bytes;
  }
  texture_barrier(hidden.commands, target.image(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                  VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  return room;
}

void Uploader::submit() { hidden_->submit(); }
void Uploader::restart() {
  CHECK(!hidden_->recording);
  hidden_->wait();
}
void Uploader::flush() { hidden_->submit_and_wait(); }

}  // namespace candela::gpu
