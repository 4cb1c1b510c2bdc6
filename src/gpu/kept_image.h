#pragma once
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "base/hash.h"
#include "gpu/physical.h"
#include "graph/kept.h"

namespace candela::gpu {

// An image that outlives the frame that fills it: imported by graphs (GraphBuilder::import_image).
class KeptImage {
 public:
  // usage: of all frames that will import it; copies out of it are always possible. Throws GpuError.
  KeptImage(Device& device, const ImageDesc& desc, VkImageUsageFlags usage);
  ~KeptImage();
  KeptImage(const KeptImage&) = delete;
  KeptImage& operator=(const KeptImage&) = delete;
  const PhysicalImage& image() const { return image_; }
  const ImageDesc& desc() const { return desc_; }
  VkImageUsageFlags usage() const { return usage_; }
  uint64_t bytes() const { return bytes_; }    // of its memory
  VkImageView view(const ViewKey& key) const;  // made when first asked for; key.resource does not matter

 private:
  void release();
  Device& device_;
  ImageDesc desc_;
  VkImageUsageFlags usage_;
  PhysicalImage image_;
  VkDeviceMemory memory_ = VK_NULL_HANDLE;
  uint64_t bytes_ = 0;
  mutable std::map<ViewKey, VkImageView> views_;
};

// Images kept from frame to frame under a hash of everything that decides their content. Never history: a frame that
// finds one has the same bytes as one that makes it. Entries that no frame used for the longest time, in the order in
// which frames were begun, go when the budget is exceeded; frames in flight keep theirs until they are done.
class ImageCache {
 public:
  ImageCache(Device& device, uint64_t budget_bytes) : device_(device), budget_bytes_(budget_bytes) {}
  void keys(KeptKeys& keys) const;
  // A planned frame has an image of that key: a key that was unknown is seen from now on, unless the image does not fit
  // the budget.
  void used(const Hash128& key, const ImageDesc& desc);
  std::shared_ptr<KeptImage> find(const Hash128& key) const;  // null: it is not here
  // An image that is not in the cache yet; it is the caller's to have filled.
  std::shared_ptr<KeptImage> make(const ImageDesc& desc, VkImageUsageFlags usage);
  // The device was given the work that fills it: frames begun later find it.
  void insert(const Hash128& key, std::shared_ptr<KeptImage> image);
  uint64_t budget_bytes() const { return budget_bytes_; }
  uint64_t used_bytes() const;
  size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    Hash128 key;
    std::shared_ptr<KeptImage> image;
  };
  void drop_to(uint64_t bytes);
  Device& device_;
  uint64_t budget_bytes_;
  std::vector<Entry> entries_;  // the one used last first
  std::vector<Hash128> seen_;   // likewise; a few
};

}  // namespace candela::gpu
