#include "gpu/kept_image.h"

#include <algorithm>

#include "gpu/image_copy.h"

namespace candela::gpu {

KeptImage::KeptImage(Device& device, const ImageDesc& desc, VkImageUsageFlags usage)
    : device_(device), desc_(desc), usage_(usage) {
  try {
    // Later frames may use it on another queue than the one that fills it.
    image_ = make_image(device, desc, {usage | VK_IMAGE_USAGE_SAMPLED_BIT, true, true});
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(device.handle(), image_.image, &needs);
    bytes_ = needs.size;
    memory_ = device.allocate(needs, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, Device::Purpose::frame);
    VK_CHECK(vkBindImageMemory(device.handle(), image_.image, memory_, 0));
  } catch (...) {
    release();
    throw;
  }
}

KeptImage::~KeptImage() { release(); }

void KeptImage::release() {
  for (const auto& [key, view] : views_) vkDestroyImageView(device_.handle(), view, nullptr);
  vkDestroyImage(device_.handle(), image_.image, nullptr);
  if (memory_) device_.release(memory_);
}

VkImageView KeptImage::view(const ViewKey& key) const {
  ViewKey own = key;
  own.resource = 0;
  VkImageView& view = views_[own];
  if (!view) view = make_view(device_, image_, desc_, own);
  return view;
}

namespace {
constexpr size_t most_seen = 256;

// What the device makes; the clear value is how it was filled, and part of the key.
}  // namespace

void ImageCache::keys(KeptKeys& keys) const {
  keys.filled.clear(), keys.seen.clear(), keys.pool.reset();
  for (const Entry& entry : entries_) keys.filled.insert(entry.key);
  for (const Hash128& key : seen_)
    if (!keys.filled.contains(key)) keys.seen.insert(key);
}

void ImageCache::used(const Hash128& key, const ImageDesc& desc) {
  const auto to_front = [](auto& all, auto found) {
    if (found == all.end()) return false;
    std::rotate(all.begin(), found, found + 1);
    return true;
  };
  if (to_front(entries_, std::ranges::find(entries_, key, &Entry::key))) return;
  if (to_front(seen_, std::ranges::find(seen_, key))) return;
  if (range_bytes(desc, whole(desc)) * desc.samples > budget_bytes_) return;
  if (seen_.size() == most_seen) seen_.pop_back();
  seen_.insert(seen_.begin(), key);
}

std::shared_ptr<KeptImage> ImageCache::find(const Hash128& key) const {
  for (const Entry& entry : entries_)
    if (entry.key == key) return entry.image;
  return nullptr;
}

std::shared_ptr<KeptImage> ImageCache::make(const ImageDesc& desc, VkImageUsageFlags usage) {
  return std::make_shared<KeptImage>(device_, desc, usage);
}

void ImageCache::insert(const Hash128& key, std::shared_ptr<KeptImage> image) {
  std::erase_if(entries_, [&](const Entry& entry) { return entry.key == key; });
  if (image->bytes() > budget_bytes_) return;
  drop_to(budget_bytes_ - image->bytes());
  entries_.insert(entries_.begin(), {key, std::move(image)});
}

uint64_t ImageCache::used_bytes() const {
  uint64_t bytes = 0;
  for (const Entry& entry : entries_) bytes += entry.image->bytes();
  return bytes;
}

void ImageCache::drop_to(uint64_t bytes) {
  while (!entries_.empty() && used_bytes() > bytes) entries_.pop_back();
}

}  // namespace candela::gpu
