#pragma once
#include <map>
#include <memory>
#include <vector>

#include "gpu/kept_image.h"
#include "plan/plan_frame.h"

namespace candela {

// The images of a plan that outlive it; to be submitted with the frame, and held until it is done.
struct KeptImages {
  std::vector<std::shared_ptr<gpu::KeptImage>> held;
  gpu::ByResource<gpu::KeptImage> by_resource;
  std::vector<std::pair<Hash128, std::shared_ptr<gpu::KeptImage>>> filled;  // by this frame
};
// cache: null: nothing is kept. lamp_image: the pool of local lights' maps, made anew where the plan says so. images:
// whatever it held, its memory is used again. Throws GpuError.
void kept_images(const PlannedFrame& planned, gpu::ImageCache* cache, std::shared_ptr<gpu::KeptImage>& lamp_image,
                 KeptImages& images);

}  // namespace candela
