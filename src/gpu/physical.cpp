#include "gpu/physical.h"

#include <algorithm>
#include <atomic>
#include <span>

#include "base/check.h"
#include "gpu/kept_image.h"
#include "graph/access.h"

namespace candela::gpu {

Hash128 physical_key(const FramePlan& plan) {
  std::vector<uint64_t> key{plan.passes.size(), plan.resources.size(), plan.block_bytes.size()};
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& resource = plan.resources[i];
    if (resource.first_pass < 0 || resource.imported) continue;
    key.insert(key.end(), {i, uint64_t(resource.lifetime), uint64_t(int64_t(resource.block)), resource.image_usage,
                           resource.buffer_usage, resource.both_queues});
    if (const auto* image = std::get_if<ImageDesc>(&resource.desc))
      key.insert(key.end(), {uint64_t(image->format), image->width_px, image->height_px, image->samples,
                             uint64_t(image->kind), image->mips, image->layers, image->depth_px});
    else
      key.push_back(std::get<BufferDesc>(resource.desc).size_bytes);
    if (const auto& part = resource.resident)
      for (const int field : {part->x, part->y, part->width, part->height}) key.push_back(uint64_t(field));
  }
  for (const PlanPass& pass : plan.passes) {
    key.insert(key.end(), {pass.uses.size(), pass.steps()});
    for (const PlanUse& use : pass.uses)
      key.insert(key.end(),
                 {uint64_t(use.resource), uint64_t(use.access), uint64_t(int64_t(use.step)), uint64_t(use.view),
                  use.range.first_mip, use.range.mip_count, use.range.first_layer, use.range.layer_count});
  }
  return hash128(std::as_bytes(std::span(key)));
}

void Physical::clear() {
  for (const auto& [key, view] : views_) vkDestroyImageView(device_.handle(), view, nullptr);
  for (PhysicalImage& image : images_) vkDestroyImage(device_.handle(), image.image, nullptr);
  views_.clear();
  images_.clear();
  buffers_.clear();
  pages_.clear();
  for (const StepSets& sets : sets_) vkDestroyDescriptorPool(device_.handle(), sets.pool, nullptr);
  sets_.clear();
  for (VkDeviceMemory memory : blocks_) device_.release(memory);
  blocks_.clear();
}

void Physical::rebuild(const FramePlan& plan, bool copyable) {
  clear();
  images_.resize(plan.resources.size());
  buffers_.resize(plan.resources.size());
  pages_.resize(plan.resources.size());
  uint64_t paged_left = device_.info().paged_bytes / 2;  // those of a frame before may be there yet
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    const PlanResource& resource = plan.resources[i];
    if (resource.first_pass < 0 || resource.imported) continue;
    if (resource.is_image())
      make_image_of(resource, i, copyable, paged_left);
    else if (resource.lifetime == Lifetime::frame)
      make_buffer_of(resource, i, copyable, paged_left);
  }
  bind_blocks(plan, copyable);
  make_views(plan, copyable);
}

void Physical::make_image_of(const PlanResource& resource, size_t i, bool copyable, uint64_t& paged_left) {
  const auto& desc = std::get<ImageDesc>(resource.desc);
  const uint64_t bytes = whole_bytes(resource);
  ImageMaking making{resource.image_usage, resource.both_queues, copyable, resource.resident && bytes <= paged_left};
  images_[i] = make_image(device_, desc, making);
  if (!images_[i].paged) return;
  pages_[i] = pages_of(device_, images_[i].image, images_[i].aspect, *resource.resident);
  if (pages_[i]) {
    paged_left -= bytes;
    return;
  }
  vkDestroyImage(device_.handle(), images_[i].image, nullptr);
  images_[i] = {};
  making.paged = false;
  images_[i] = make_image(device_, desc, making);
}

void Physical::make_buffer_of(const PlanResource& resource, size_t i, bool copyable, uint64_t& paged_left) {
  const auto& desc = std::get<BufferDesc>(resource.desc);
  VkBufferUsageFlags usage = resource.buffer_usage;
  if (copyable) usage |= VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
  if (resource.resident && !copyable && desc.size_bytes <= paged_left) {
    paged_left -= desc.size_bytes;
    buffers_[i] = Buffer(device_, desc.size_bytes, usage, desc.name.c_str(), paged_buffer_flags);
    const auto row = [&](int y) { return uint64_t(y) * desc.row_bytes; };
    pages_[i] = pages_of(device_, buffers_[i].handle(), row(resource.resident->y), row(resource.resident->end_y()));
  } else if (resource.block < 0 || copyable) {
    // What is hashed may not hold what another buffer left in the bytes that it does not write.
    buffers_[i] =
        Buffer(device_, desc.size_bytes, usage, Buffer::Memory::device, Device::Purpose::frame, desc.name.c_str());
  } else {
    buffers_[i] = Buffer(device_, desc.size_bytes, usage, desc.name.c_str());
  }
}

void Physical::make_step_sets(const FramePlan& plan, StepSets& into) {
  uint32_t sets = 0;
  for (const PlanPass& pass : plan.passes) sets += pass.steps();
  if (sets == 0) return;
  std::vector<VkDescriptorPoolSize> sizes(std::begin(Bindless::pass_sizes), std::end(Bindless::pass_sizes));
  for (VkDescriptorPoolSize& size : sizes) size.descriptorCount *= sets;
  VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
  info.maxSets = sets;
  info.poolSizeCount = uint32_t(sizes.size());
  info.pPoolSizes = sizes.data();
  VK_CHECK(vkCreateDescriptorPool(device_.handle(), &info, nullptr, &into.pool));
  try {
    for (const PlanPass& pass : plan.passes) {
      into.passes.emplace_back(pass.steps());
      for (uint32_t step = 0; step < pass.steps(); ++step)
        write_step_set(plan, pass, step, into.pool, into.passes.back()[step]);
    }
  } catch (...) {  // half of the sets are none
    vkDestroyDescriptorPool(device_.handle(), into.pool, nullptr);
    into = {};
    throw;
  }
}

void Physical::write_step_set(const FramePlan& plan, const PlanPass& pass, uint32_t step, VkDescriptorPool pool,
                              StepImages& images) {
  const VkDescriptorSetLayout layout = bindless_.pass_set_layout();
  VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
  info.descriptorPool = pool;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VK_CHECK(vkAllocateDescriptorSets(device_.handle(), &info, &images.set));
  device_.set_name(VK_OBJECT_TYPE_DESCRIPTOR_SET, uint64_t(images.set), pass.name);
  for (const PlanUse& use : pass.uses) {
    const bool sampled = is_sampled(use.access);
    const bool storage = use.access == Access::storage_image_write || use.access == Access::storage_image_read_write ||
                         use.access == Access::storage_image_read;
    if ((!sampled && !storage) || !use.in_step(step)) continue;
    auto& places = sampled ? images.sampled : images.storage;
    const ViewKey key = view_key(use);
    if (places.contains(key)) continue;
    const uint32_t place = uint32_t(places.size());
    CHECK_MSG(place < (sampled ? Bindless::pass_sampled : Bindless::pass_storage), pass.name);
    places[key] = place;
    if (plan.resources[size_t(use.resource)].imported) continue;  // bind_imports
    const VkFormat format = std::get<ImageDesc>(plan.resources[size_t(use.resource)].desc).format;
    write_image(images.set, !sampled, place, {VK_NULL_HANDLE, view(key), image_layout(use.access, format)});
  }
}

void Physical::write_image(VkDescriptorSet set, bool storage, uint32_t place,
                           const VkDescriptorImageInfo& image) const {
  const VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   nullptr,
                                   set,
                                   storage ? 1u : 0u,
                                   place,
                                   1,
                                   storage ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE,
                                   &image};
  vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
}

void Physical::bind_imports(const FramePlan& plan, size_t slot, std::span<const KeptImage* const> images) {
  for (size_t pass = 0; pass < plan.passes.size(); ++pass)
    for (const StepImages& step : sets_[slot].passes[pass])
      for (const bool storage : {false, true})
        for (const auto& [key, place] : storage ? step.storage : step.sampled) {
          const PlanResource& resource = plan.resources[size_t(key.resource)];
          if (!resource.imported) continue;
          const Access access = storage ? Access::storage_image_write : Access::sampled_fragment;
          const VkFormat format = std::get<ImageDesc>(resource.desc).format;
          write_image(step.set, storage, place,
                      {VK_NULL_HANDLE, images[size_t(key.resource)]->view(key), image_layout(access, format)});
        }
}

void Physical::bind_uniforms(const FramePlan& plan, size_t slot, std::span<const Buffer* const> buffers) {
  if (slot >= sets_.size()) sets_.resize(slot + 1);
  if (!sets_[slot].pool) make_step_sets(plan, sets_[slot]);
  for (size_t i = 0; i < plan.passes.size(); ++i)
    for (const PlanUse& use : plan.passes[i].uses) {
      if (use.access != Access::uniform_read) continue;
      const VkDescriptorBufferInfo buffer{buffers[size_t(use.resource)]->handle(), 0,
                                          std::get<BufferDesc>(plan.resources[size_t(use.resource)].desc).size_bytes};
      for (uint32_t step = 0; step < plan.passes[i].steps(); ++step) {
        if (!use.in_step(step)) continue;
        const VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                         nullptr,
                                         sets_[slot].passes[i][step].set,
                                         2,
                                         0,
                                         1,
                                         VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
                                         nullptr,
                                         &buffer};
        vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
      }
    }
}

namespace {
bool can_make(VkPhysicalDevice device, const VkImageCreateInfo& info, VkImageUsageFlags usage) {
  VkImageFormatProperties properties;
  return vkGetPhysicalDeviceImageFormatProperties(device, info.format, info.imageType, info.tiling, usage, info.flags,
                                                  &properties) == VK_SUCCESS &&
         (properties.sampleCounts & info.samples);
}
}  // namespace

PhysicalImage make_image(Device& device, const ImageDesc& desc, const ImageMaking& making) {
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = desc.kind == ImageKind::d3 ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D;
  if (desc.kind == ImageKind::cube || desc.kind == ImageKind::cube_array)
    info.flags = VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT;
  info.format = desc.format;
  info.extent = {desc.width_px, desc.height_px, desc.depth_px};
  info.mipLevels = desc.mips;
  info.arrayLayers = desc.layers;
  info.samples = VkSampleCountFlagBits(desc.samples);
  info.usage = making.usage;
  // Depth is sampled in a layout that only attachments have (graph/access.h).
  if (is_depth_format(desc.format)) info.usage |= VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
  if (making.both_queues) share(device, info);
  if (making.copyable) {
    const VkImageUsageFlags more = desc.samples > 1 ? VK_IMAGE_USAGE_SAMPLED_BIT : VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    if (desc.samples == 1 || can_make(device.physical(), info, info.usage | more)) info.usage |= more;
  }
  PhysicalImage image;
  image.paged = making.paged && can_be_paged(device, info);
  if (image.paged) info.flags |= paged_image_flags;
  image.sampled = info.usage & VK_IMAGE_USAGE_SAMPLED_BIT;
  VK_CHECK(vkCreateImage(device.handle(), &info, nullptr, &image.image));
  image.texels = is_depth_format(desc.format) ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
  image.aspect = image.texels | (has_stencil(desc.format) ? VK_IMAGE_ASPECT_STENCIL_BIT : 0);
  device.set_name(VK_OBJECT_TYPE_IMAGE, uint64_t(image.image), desc.name);
  return image;
}

VkMemoryRequirements Physical::needs_of(size_t i) const {
  if (pages_[i]) return pages_[i]->needs;
  if (!images_[i].image) return buffers_[i].requirements();
  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(device_.handle(), images_[i].image, &needs);
  return needs;
}

void Physical::bind_blocks(const FramePlan& plan, bool copyable) {
  const auto shares = [&](size_t i) {
    return plan.resources[i].block >= 0 && (images_[i].image || (buffers_[i] && !copyable));
  };
  std::vector<VkMemoryRequirements> needs(plan.block_bytes.size(), {0, 1, ~0u});
  std::vector<bool> apart(plan.resources.size());  // what is on pages may need memory of another type
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    CHECK_MSG(!images_[i].image || plan.resources[i].block >= 0, plan.resources[i].name());
    if (!shares(i)) continue;
    const VkMemoryRequirements own = needs_of(i);
    VkMemoryRequirements& block = needs[size_t(plan.resources[i].block)];
    apart[i] = (block.memoryTypeBits & own.memoryTypeBits) == 0;
    if (apart[i]) continue;
    block.size = std::max(block.size, own.size);
    block.alignment = std::max(block.alignment, own.alignment);
    block.memoryTypeBits &= own.memoryTypeBits;
  }
  blocks_.resize(needs.size(), VK_NULL_HANDLE);
  for (size_t block = 0; block < needs.size(); ++block)
    if (needs[block].size > 0)
      blocks_[block] = device_.allocate(needs[block], 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, Device::Purpose::frame);
  std::vector<PageBinding> paged;
  for (size_t i = 0; i < plan.resources.size(); ++i) {
    if (shares(i) && !apart[i]) {
      bind_to(i, blocks_[size_t(plan.resources[i].block)], paged);
    } else if (pages_[i] || apart[i]) {
      blocks_.push_back(device_.allocate(needs_of(i), 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, Device::Purpose::frame));
      bind_to(i, blocks_.back(), paged);
    }
  }
  bind_pages(device_, paged);
}

void Physical::bind_to(size_t i, VkDeviceMemory memory, std::vector<PageBinding>& paged) {
  if (pages_[i]) {
    paged.push_back({images_[i].image, images_[i].image ? VK_NULL_HANDLE : buffers_[i].handle(), &*pages_[i], memory});
    if (!images_[i].image) buffers_[i].find_address();
  } else if (images_[i].image) {
    VK_CHECK(vkBindImageMemory(device_.handle(), images_[i].image, memory, 0));
  } else {
    buffers_[i].bind(memory);
  }
}

namespace {
VkImageViewType view_type(ImageKind kind) {
  constexpr VkImageViewType types[] = {VK_IMAGE_VIEW_TYPE_2D, VK_IMAGE_VIEW_TYPE_2D_ARRAY, VK_IMAGE_VIEW_TYPE_CUBE,
                                       VK_IMAGE_VIEW_TYPE_CUBE_ARRAY, VK_IMAGE_VIEW_TYPE_3D};
  return types[int(kind)];
}
}  // namespace

VkImageView make_view(Device& device, const PhysicalImage& image, const ImageDesc& desc, const ViewKey& key,
                      VkImageUsageFlags usage) {
  const VkImageViewUsageCreateInfo narrowed{VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO, nullptr, usage};
  VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO, usage ? &narrowed : nullptr};
  info.image = image.image;
  info.viewType = view_type(key.kind);
  info.format = desc.format;
  info.subresourceRange = subresources(image, key.range);
  if (!key.drawn) info.subresourceRange.aspectMask = image.texels;
  VkImageView view = VK_NULL_HANDLE;
  VK_CHECK(vkCreateImageView(device.handle(), &info, nullptr, &view));
  device.set_name(VK_OBJECT_TYPE_IMAGE_VIEW, uint64_t(view), desc.name + range_text(key.range, desc));
  return view;
}

// What is hashed is sampled through any of them.
void Physical::make_views(const FramePlan& plan, bool copyable) {
  std::map<ViewKey, VkImageUsageFlags> usages;
  for (const PlanPass& pass : plan.passes)
    for (const PlanUse& use : pass.uses) {
      const VkImageUsageFlags usage = access_info(use.access).image_usage & viewable_usage;
      const PlanResource& resource = plan.resources[size_t(use.resource)];
      if (usage && resource.is_image() && !resource.imported) usages[view_key(use)] |= usage;
    }
  for (const auto& [key, usage] : usages) {
    const size_t i = size_t(key.resource);
    views_[key] =
        make_view(device_, images_[i], std::get<ImageDesc>(plan.resources[i].desc), key, copyable ? 0 : usage);
  }
}

std::shared_ptr<ReadbackPool::Pooled> ReadbackPool::take(Device& device, uint64_t bytes, VkBufferUsageFlags usage,
                                                         const std::string& name) {
  for (const auto& pooled : all_) {
    if (pooled.use_count() != 1 || pooled->usage() != usage || pooled->buffer().size() != bytes) continue;
    std::atomic_thread_fence(std::memory_order_acquire);  // of what another thread did before it let go
    return pooled;
  }
  return all_.emplace_back(std::make_shared<Pooled>(
      Buffer(device, bytes, usage, Buffer::Memory::host_read, Device::Purpose::readback, name.c_str()), usage));
}

void ReadbackPool::trim() {
  std::erase_if(all_, [](const auto& pooled) { return pooled.use_count() == 1; });
}

}  // namespace candela::gpu
