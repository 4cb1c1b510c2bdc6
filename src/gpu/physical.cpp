#include "gpu/physical.h"

#include "base/check.h"
#include "graph/access.h"

namespace candela::gpu {

void Physical::clear() {
  for (PhysicalImage& image : images_) {
    if (image.sampled != PhysicalImage::none) bindless_.remove_sampled(image.sampled);
    if (image.storage != PhysicalImage::none) bindless_.remove_storage(image.storage);
    vkDestroyImageView(device_.handle(), image.view, nullptr);
    vkDestroyImage(device_.handle(), image.image, nullptr);
  }
  images_.clear();
  buffers_.clear();
  for (VkDeviceMemory memory : blocks_) device_.release(memory);
  blocks_.clear();
}

void Physical::rebuild(const FramePlan& plan, bool copyable) {
  clear();
  images_.resize(plan.resources.size());
  buffers_.resize(plan.resources.size());
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& resource = plan.resources[i];
    if (resource.first_pass < 0 || resource.imported) continue;
    if (resource.is_image()) {
      make_image(resource, copyable, images_[i]);
    } else if (resource.lifetime == Lifetime::frame) {
      const auto& desc = std::get<BufferDesc>(resource.desc);
      VkBufferUsageFlags usage = resource.buffer_usage;
      if (copyable) usage |= VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
      buffers_[i] =
          Buffer(device_, desc.size_bytes, usage, Buffer::Memory::device, Device::Purpose::frame, desc.name.c_str());
    }
  }
  bind_blocks(plan);
  for (size_t i = 0; i < plan.resources.size(); ++i)
    if (images_[i].image) make_view(plan.resources[i], images_[i]);
}

void Physical::make_image(const PlanResource& resource, bool copyable, PhysicalImage& image) {
  const auto& desc = std::get<ImageDesc>(resource.desc);
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = desc.format;
  info.extent = {desc.width_px, desc.height_px, 1};
  info.mipLevels = info.arrayLayers = 1;
  info.samples = VkSampleCountFlagBits(desc.samples);
  info.usage = resource.image_usage | (copyable && desc.samples == 1 ? VK_IMAGE_USAGE_TRANSFER_SRC_BIT : 0);
  VK_CHECK(vkCreateImage(device_.handle(), &info, nullptr, &image.image));
  image.aspect = is_depth_format(desc.format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  device_.set_name(VK_OBJECT_TYPE_IMAGE, uint64_t(image.image), desc.name);
}

void Physical::bind_blocks(const FramePlan& plan) {
  std::vector<VkMemoryRequirements> needs(plan.block_bytes.size(), {0, 1, ~0u});
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    if (!images_[i].image) continue;
    VkMemoryRequirements own;
    vkGetImageMemoryRequirements(device_.handle(), images_[i].image, &own);
    CHECK_MSG(plan.resources[i].block >= 0, plan.resources[i].name());
    VkMemoryRequirements& block = needs[size_t(plan.resources[i].block)];
    block.size = std::max(block.size, own.size);
    block.alignment = std::max(block.alignment, own.alignment);
    block.memoryTypeBits &= own.memoryTypeBits;
  }
  blocks_.resize(needs.size(), VK_NULL_HANDLE);
  for (size_t block = 0; block < needs.size(); ++block)
    if (needs[block].size > 0)
      blocks_[block] = device_.allocate(needs[block], 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, Device::Purpose::frame);
  for (size_t i = 0; i < plan.resources.size(); ++i)
    if (images_[i].image)
      VK_CHECK(vkBindImageMemory(device_.handle(), images_[i].image, blocks_[size_t(plan.resources[i].block)], 0));
}

void Physical::make_view(const PlanResource& resource, PhysicalImage& image) {
  const auto& desc = std::get<ImageDesc>(resource.desc);
  constexpr VkImageUsageFlags viewable = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
                                         VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                         VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  if (!(resource.image_usage & viewable)) return;  // only copied
  VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  info.image = image.image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = desc.format;
  info.subresourceRange = {image.aspect, 0, 1, 0, 1};
  VK_CHECK(vkCreateImageView(device_.handle(), &info, nullptr, &image.view));
  device_.set_name(VK_OBJECT_TYPE_IMAGE_VIEW, uint64_t(image.view), desc.name);
  if (resource.image_usage & VK_IMAGE_USAGE_SAMPLED_BIT)
    image.sampled = bindless_.add_sampled(image.view, image_layout(Access::sampled_fragment, desc.format));
  if (resource.image_usage & VK_IMAGE_USAGE_STORAGE_BIT) image.storage = bindless_.add_storage(image.view);
}

ReadbackPool::Pooled::~Pooled() {
  std::lock_guard lock(pool_->mutex_);
  pool_->free_.push_back({std::move(buffer_), usage_});
}

std::shared_ptr<ReadbackPool::Pooled> ReadbackPool::take(Device& device, uint64_t bytes, VkBufferUsageFlags usage,
                                                         const std::string& name) {
  std::lock_guard lock(mutex_);
  for (Free& entry : free_) {
    if (entry.usage != usage || entry.buffer.size() != bytes) continue;
    Buffer buffer = std::move(entry.buffer);
    std::swap(entry, free_.back());
    free_.pop_back();
    return std::make_shared<Pooled>(shared_from_this(), std::move(buffer), usage);
  }
  Buffer buffer(device, bytes, usage, Buffer::Memory::host_read, Device::Purpose::readback, name.c_str());
  return std::make_shared<Pooled>(shared_from_this(), std::move(buffer), usage);
}

void ReadbackPool::trim() {
  std::lock_guard lock(mutex_);
  free_.clear();
}

}  // namespace candela::gpu
