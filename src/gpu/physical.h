#pragma once
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gpu/bindless.h"
#include "gpu/device.h"
#include "gpu/frame_runner.h"
#include "gpu/pages.h"
#include "gpu/resources.h"
#include "graph/plan.h"

namespace candela::gpu {

struct PhysicalImage {
  VkImage image = VK_NULL_HANDLE;
  VkImageAspectFlags aspect = 0;  // what barriers and attachments mean
  VkImageAspectFlags texels = 0;  // what shaders read and copies move: depth, of depth and stencil
  bool sampled = false;           // made with SAMPLED usage
  bool paged = false;             // made for memory by pages
};

constexpr VkImageUsageFlags viewable_usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT |
                                             VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                             VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;

struct ImageMaking {
  VkImageUsageFlags usage = 0;
  bool both_queues = false;
  bool copyable = false;  // also the source of copies, or sampled where multisampled images cannot be copied
  bool paged = false;     // for memory by pages, where the device can
};
PhysicalImage make_image(Device& device, const ImageDesc& desc, const ImageMaking& making);  // without memory

inline VkImageSubresourceRange subresources(const PhysicalImage& image, const ImageRange& range) {
  return {image.aspect, range.first_mip, range.mip_count, range.first_layer, range.layer_count};
}

// What a descriptor or an attachment sees of an image.
struct ViewKey {
  int resource = -1;
  ImageRange range;  // in numbers
  ImageKind kind = ImageKind::d2;
  bool drawn = false;  // an attachment: of all aspects
  auto operator<=>(const ViewKey&) const = default;
};
inline ViewKey view_key(const PlanUse& use) {
  constexpr VkImageUsageFlags attachments =
      VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  return {use.resource, use.range, use.view, (access_info(use.access).image_usage & attachments) != 0};
}

// usage: of what the view is for; 0: all that the image is made for. lavapipe compiles functions for each view that may
// be sampled or stored to.
VkImageView make_view(Device& device, const PhysicalImage& image, const ImageDesc& desc, const ViewKey& key,
                      VkImageUsageFlags usage = 0);

class KeptImage;

// The images that one step of a pass reaches through descriptors: its set 1, and each view's place in the two bindings.
struct StepImages {
  VkDescriptorSet set = VK_NULL_HANDLE;
  std::map<ViewKey, uint32_t> sampled, storage;
};

// Of everything that Physical::rebuild looks at: equal keys mean that the same images, buffers and sets serve both
// plans, whatever the plans import.
Hash128 physical_key(const FramePlan& plan);

// The images and device buffers that a plan names. What is in one alias block shares one piece of memory; while outputs
// are hashed, buffers have their own.
class Physical {
 public:
  Physical(Device& device, Bindless& bindless) : device_(device), bindless_(bindless) {}
  ~Physical() { clear(); }
  Physical(const Physical&) = delete;
  Physical& operator=(const Physical&) = delete;
  // Frees what is there and makes what `plan` names. copyable: everything may also be the source of a copy, or
  // sampled where multisampled images cannot be copied (hashing).
  void rebuild(const FramePlan& plan, bool copyable);
  void clear();
  const PhysicalImage& image(int resource) const { return images_[size_t(resource)]; }
  // Whether only what is resident of it (PlanResource) has memory.
  bool has_pages(int resource) const { return pages_[size_t(resource)].has_value(); }
  VkImageView view(const ViewKey& key) const { return views_.at(key); }
  // slot: of the frame in flight. Each slot has sets of its own, made when it is first bound.
  const StepImages& step_images(size_t slot, size_t pass, uint32_t step) const {
    return sets_[slot].passes[pass][step];
  }
  // Writes the block of uniforms of each pass into the slot's sets, which no frame may be using. buffers: by resource.
  void bind_uniforms(const FramePlan& plan, size_t slot, std::span<const Buffer* const> buffers);
  // The same for imported images, after bind_uniforms. images: by resource.
  void bind_imports(const FramePlan& plan, size_t slot, std::span<const KeptImage* const> images);
  const Buffer& buffer(int resource) const {
    return buffers_[size_t(resource)];
  }  // empty: imported, read back, or unused

 private:
  void make_image_of(const PlanResource& resource, size_t i, bool copyable, uint64_t& paged_left);
  void make_buffer_of(const PlanResource& resource, size_t i, bool copyable, uint64_t& paged_left);
  VkMemoryRequirements needs_of(size_t i) const;
  void bind_blocks(const FramePlan& plan, bool copyable);
  void bind_to(size_t i, VkDeviceMemory memory, std::vector<PageBinding>& paged);
  void make_views(const FramePlan& plan, bool copyable);
  struct StepSets {
    VkDescriptorPool pool = VK_NULL_HANDLE;
    std::vector<std::vector<StepImages>> passes;  // by pass and step
  };
  void make_step_sets(const FramePlan& plan, StepSets& into);
  void write_step_set(const FramePlan& plan, const PlanPass& pass, uint32_t step, VkDescriptorPool pool,
                      StepImages& images);

  void write_image(VkDescriptorSet set, bool storage, uint32_t place, const VkDescriptorImageInfo& image) const;

  Device& device_;
  Bindless& bindless_;
  std::vector<PhysicalImage> images_;        // by resource
  std::vector<Buffer> buffers_;              // by resource
  std::vector<std::optional<Pages>> pages_;  // by resource; empty: it has memory for all of it
  std::map<ViewKey, VkImageView> views_;
  std::vector<StepSets> sets_;  // by slot
  std::vector<VkDeviceMemory> blocks_;
};

// Host-visible buffers that frames write and the host reads. One that the pool alone holds is taken again; the last
// owner of its Readback may let go from any thread. They must not outlive the device.
class ReadbackPool {
 public:
  class Pooled : public Readback {
   public:
    Pooled(Buffer buffer, VkBufferUsageFlags usage) : buffer_(std::move(buffer)), usage_(usage) {}
    ~Pooled() override = default;
    std::span<const std::byte> bytes() const override { return {buffer_.mapped(), buffer_.size()}; }
    const Buffer& buffer() const { return buffer_; }
    VkBufferUsageFlags usage() const { return usage_; }

   private:
    Buffer buffer_;
    VkBufferUsageFlags usage_;
  };
  std::shared_ptr<Pooled> take(Device& device, uint64_t bytes, VkBufferUsageFlags usage, const std::string& name);
  void trim();  // frees the buffers that are not held

 private:
  std::vector<std::shared_ptr<Pooled>> all_;
};

}  // namespace candela::gpu
