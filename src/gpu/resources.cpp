#include "gpu/resources.h"

#include "base/check.h"

namespace candela::gpu {

namespace {
struct MemoryFlags {
  VkMemoryPropertyFlags wanted, preferred;
};
MemoryFlags memory_flags(Buffer::Memory memory) {
  switch (memory) {
    case Buffer::Memory::device:
      return {0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
    // Every device has a type that is host-visible and coherent; written front to back, so caching does not matter;
    // shaders read it in place, so the device's own memory is preferred.
    case Buffer::Memory::upload:
      return {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
              VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
    // Reading uncached memory is slower by an order of magnitude.
    default:
      return {VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT, VK_MEMORY_PROPERTY_HOST_CACHED_BIT};
  }
}
}  // namespace

Buffer::Buffer(Device& device, uint64_t size_bytes, VkBufferUsageFlags usage, Memory memory, Device::Purpose purpose,
               const char* name)
    : device_(&device), size_(size_bytes) {
  try {
    create(usage, name);
    const VkMemoryRequirements needs = requirements();
    const MemoryFlags flags = memory_flags(memory);
    memory_ = device.allocate(needs, flags.wanted, flags.preferred, purpose);
    device.set_name(VK_OBJECT_TYPE_DEVICE_MEMORY, uint64_t(memory_), name);
    VK_CHECK(vkBindBufferMemory(device.handle(), buffer_, memory_, 0));
    if (memory != Memory::device) {
      void* mapped = nullptr;
      VK_CHECK(vkMapMemory(device.handle(), memory_, 0, VK_WHOLE_SIZE, 0, &mapped));
      mapped_ = static_cast<std::byte*>(mapped);
    }
    find_address();
  } catch (...) {
    this->~Buffer();
    throw;
  }
}

Buffer::Buffer(Device& device, uint64_t size_bytes, VkBufferUsageFlags usage, const char* name,
               VkBufferCreateFlags flags)
    : device_(&device), size_(size_bytes) {
  create(usage, name, flags);
}

void Buffer::create(VkBufferUsageFlags usage, const char* name, VkBufferCreateFlags flags) {
  VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
  info.flags = flags;
  info.size = (std::max<uint64_t>(size_, 16) + 3) & ~3ull;  // Vulkan has no empty buffers; fills go by four bytes
  info.usage = usage_ = usage;
  share(*device_, info);
  VK_CHECK(vkCreateBuffer(device_->handle(), &info, nullptr, &buffer_));
  device_->set_name(VK_OBJECT_TYPE_BUFFER, uint64_t(buffer_), name);
}

VkMemoryRequirements Buffer::requirements() const {
  VkMemoryRequirements needs;
  vkGetBufferMemoryRequirements(device_->handle(), buffer_, &needs);
  return needs;
}

void Buffer::bind(VkDeviceMemory shared) {
  VK_CHECK(vkBindBufferMemory(device_->handle(), buffer_, shared, 0));
  find_address();
}

void Buffer::find_address() {
  if (!(usage_ & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT)) return;
  VkBufferDeviceAddressInfo address{VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO, nullptr, buffer_};
  address_ = vkGetBufferDeviceAddress(device_->handle(), &address);
}

Buffer::~Buffer() {
  if (!device_) return;
  vkDestroyBuffer(device_->handle(), buffer_, nullptr);
  device_->release(memory_);  // unmaps
}

Buffer::Buffer(Buffer&& other) noexcept { *this = std::move(other); }
Buffer& Buffer::operator=(Buffer&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(buffer_, other.buffer_);
  std::swap(usage_, other.usage_);
  std::swap(memory_, other.memory_);
  std::swap(size_, other.size_);
  std::swap(address_, other.address_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

void Buffer::invalidate() const {
  // Allowed, and without effect, for coherent memory.
  VkMappedMemoryRange range{VK_STRUCTURE_TYPE_MAPPED_MEMORY_RANGE, nullptr, memory_, 0, VK_WHOLE_SIZE};
  VK_CHECK(vkInvalidateMappedMemoryRanges(device_->handle(), 1, &range));
}

Texture::Texture(Device& device, const TextureData& shape, const char* name) : device_(&device) {
  CHECK(!shape.levels.empty() && shape.width > 0 && shape.height > 0);
  try {
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = shape.format;
    info.extent = {shape.width, shape.height, 1};
    info.mipLevels = uint32_t(shape.levels.size());
    info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    share(device, info);
    VK_CHECK(vkCreateImage(device.handle(), &info, nullptr, &image_));
    device.set_name(VK_OBJECT_TYPE_IMAGE, uint64_t(image_), name);
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device.handle(), image_, &needs);
    memory_ = device.allocate(needs, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, Device::Purpose::scene);
    VK_CHECK(vkBindImageMemory(device.handle(), image_, memory_, 0));
    VkImageViewCreateInfo view{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view.image = image_;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = shape.format;
    view.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, info.mipLevels, 0, 1};
    VK_CHECK(vkCreateImageView(device.handle(), &view, nullptr, &view_));
    device.set_name(VK_OBJECT_TYPE_IMAGE_VIEW, uint64_t(view_), name);
  } catch (...) {
    this->~Texture();
    throw;
  }
}

Texture::~Texture() {
  if (!device_) return;
  vkDestroyImageView(device_->handle(), view_, nullptr);
  vkDestroyImage(device_->handle(), image_, nullptr);
  device_->release(memory_);
}

Texture::Texture(Texture&& other) noexcept { *this = std::move(other); }
Texture& Texture::operator=(Texture&& other) noexcept {
  std::swap(device_, other.device_);
  std::swap(image_, other.image_);
  std::swap(view_, other.view_);
  std::swap(memory_, other.memory_);
  return *this;
}

}  // namespace candela::gpu
