#include "plan/step_dumps.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "graph/image_range.h"

namespace candela {
namespace {

constexpr uint32_t most_mips = 6, most_layers = 6, most_slices = 6;

// Of so many, `most` that lie evenly.
std::vector<uint32_t> some_of(uint32_t count, uint32_t most) {
  std::vector<uint32_t> some;
  const uint32_t taken = std::min(count, most);
  for (uint32_t i = 0; i < taken; ++i) some.push_back(uint32_t(uint64_t(2 * i + 1) * count / (2 * taken)));
  return some;
}

}  // namespace

std::vector<DumpRequest> requests_of_steps(const FramePlan& plan) {
  std::vector<DumpRequest> requests;
  for (const PlanPass& pass : plan.passes) {
    std::set<std::tuple<int, uint32_t, uint32_t>> seen;
    for (const PlanUse& use : pass.uses) {
      const PlanResource& resource = plan.resources[size_t(use.resource)];
      if (!use.writes || !resource.is_image()) continue;
      const ImageDesc& image = std::get<ImageDesc>(resource.desc);
      const bool is_volume = image.kind == ImageKind::d3;
      const uint32_t end_mip = std::min(use.range.first_mip + use.range.mip_count, most_mips);
      for (uint32_t mip = use.range.first_mip; mip < end_mip; ++mip) {
        const std::vector<uint32_t> layers = is_volume ? some_of(mip_size(image.depth_px, mip), most_slices)
                                                       : some_of(use.range.layer_count, most_layers);
        for (const uint32_t layer : layers) {
          const uint32_t place = is_volume ? layer : use.range.first_layer + layer;
          if (seen.insert({use.resource, mip, place}).second)
            requests.push_back({fmt::format("{}.{}", pass.name, resource.name()), mip, place, "--steps"});
        }
      }
    }
  }
  return requests;
}

}  // namespace candela
