#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "gpu/device.h"

namespace candela::gpu {

// A buffer with its memory. Device buffers have an address; host ones are mapped for their whole life.
class Buffer {
 public:
  enum class Memory {
    device,
    upload,
    host_read
  };  // upload: host-visible, written by the CPU, read by the GPU in place
  Buffer() = default;
  Buffer(Device& device, uint64_t size_bytes, VkBufferUsageFlags usage, Memory memory, Device::Purpose purpose,
         const char* name);
  // Without memory of its own: nothing may be done with it before bind.
  Buffer(Device& device, uint64_t size_bytes, VkBufferUsageFlags usage, const char* name,
         VkBufferCreateFlags flags = 0);
  VkMemoryRequirements requirements() const;
  void bind(VkDeviceMemory shared);  // at its begin; the memory's owner outlives the buffer
  void find_address();               // instead, where its pages are bound (gpu/pages.h)
  ~Buffer();
  Buffer(Buffer&& other) noexcept;
  Buffer& operator=(Buffer&& other) noexcept;
  VkBuffer handle() const { return buffer_; }
  uint64_t size() const { return size_; }
  uint64_t address() const { return address_; }
  std::byte* mapped() const { return mapped_; }
  void invalidate()
      const;  // host_read: makes what the device wrote visible to the CPU; after the wait, before the read
  explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

 private:
  Device* device_ = nullptr;
  void create(VkBufferUsageFlags usage, const char* name, VkBufferCreateFlags flags = 0);
  VkBuffer buffer_ = VK_NULL_HANDLE;
  VkBufferUsageFlags usage_ = 0;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  uint64_t size_ = 0, address_ = 0;
  std::byte* mapped_ = nullptr;
};

// Of a buffer or an image to be made: usable by both queues (Device::shared_families).
template <class CreateInfo>
void share(const Device& device, CreateInfo& info) {
  const std::span<const uint32_t> families = device.shared_families();
  if (families.empty()) return;
  info.sharingMode = VK_SHARING_MODE_CONCURRENT;
  info.queueFamilyIndexCount = uint32_t(families.size());
  info.pQueueFamilyIndices = families.data();
}

// One mip chain of a texture on the CPU, tightly packed levels.
struct TextureData {
  VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;
  uint32_t width = 0, height = 0;
  std::vector<std::vector<std::byte>> levels;  // at least one
};

class Texture {  // sampled image, device memory
 public:
  Texture() = default;
  Texture(Device& device, const TextureData& shape, const char* name);  // contents come through Uploader
  ~Texture();
  Texture(Texture&& other) noexcept;
  Texture& operator=(Texture&& other) noexcept;
  VkImage image() const { return image_; }
  VkImageView view() const { return view_; }

 private:
  Device* device_ = nullptr;
  VkImage image_ = VK_NULL_HANDLE;
  VkImageView view_ = VK_NULL_HANDLE;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

// Copies bytes into device buffers and textures through staging memory. What is submitted after submit() or flush() on
// the same queue sees them.
class Uploader {
 public:
  static constexpr uint64_t usual_staging_bytes = 16 << 20;
  explicit Uploader(Device& device, uint64_t staging_bytes = usual_staging_bytes);
  ~Uploader();  // waits for what was submitted
  void to_buffer(Buffer& target, uint64_t offset, std::span<const std::byte> bytes);
  void to_texture(Texture& target, const TextureData& data);  // ends in SHADER_READ_ONLY_OPTIMAL
  void to_texture(Texture& target, TextureData&& data);       // the same; memory is given back as it is copied
  // Of a shape of one level, whose own bytes are not asked for.
  void to_texture(Texture& target, const TextureData& shape, std::vector<float>&& texels);
  // Likewise, where the caller writes the levels, tightly packed one behind the other, before submit(): slow to read.
  // They fit into the staging memory.
  std::span<std::byte> texture_room(Texture& target, VkFormat format, uint32_t width, uint32_t height, uint32_t levels,
                                    uint32_t texel_bytes);
  void submit();   // without waiting; nothing may be added after it but by restart()
  void restart();  // waits for what was submitted; more may be added
  void flush();    // and waits

 private:
  struct Hidden;
  std::unique_ptr<Hidden> hidden_;
};

}  // namespace candela::gpu
