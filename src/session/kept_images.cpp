#include "session/kept_images.h"

#include <algorithm>

#include "base/check.h"

namespace candela {

void kept_images(const PlannedFrame& planned, gpu::ImageCache* cache, std::shared_ptr<gpu::KeptImage>& lamp_image,
                 KeptImages& images) {
  images.held.clear(), images.by_resource.clear(), images.filled.clear();
  const std::vector<PlanResource>& resources = planned.graph().plan.resources;
  for (size_t r = 0; r < resources.size() && cache; ++r) {
    const PlanResource& resource = resources[r];
    if (resource.pooled && resource.first_pass >= 0) {
      if (planned.lamps.pool->fresh || !lamp_image)
        lamp_image = cache->make(std::get<ImageDesc>(resource.desc), resource.image_usage);
      images.held.push_back(lamp_image);
      images.by_resource[int(r)] = lamp_image.get();
    }
    if (!resource.keyed) continue;
    const auto& keys = planned.graph().keys;
    const Hash128& key = std::ranges::find(keys, int(r), &std::pair<int, Hash128>::first)->second;
    const ImageDesc& desc = std::get<ImageDesc>(resource.desc);
    cache->used(key, desc);
    if (!resource.imported || resource.first_pass < 0) continue;
    images.held.push_back(resource.to_fill ? cache->make(desc, resource.image_usage) : cache->find(key));
    CHECK_MSG(images.held.back(), desc.name);
    images.by_resource[int(r)] = images.held.back().get();
    if (resource.to_fill) images.filled.emplace_back(key, images.held.back());
  }
}

}  // namespace candela
