#include "graph/picture_parts.h"

#include <cmath>

#include "passes/occlusion/occlusion.h"
#include "passes/post/bloom.h"
#include "passes/post/exposure.h"
#include "passes/post/motion_blur.h"
#include "passes/post/smooth_edges.h"
#include "passes/reflections/reflections.h"
#include "passes/surfaces/refraction.h"
#include "passes/transparency/phenomenological.h"
#include "passes/volumes/fog_march.h"
#include "passes/volumes/volumetric.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// Parts are of whole tiles of all passes that work by tiles.
constexpr int part_step_px = 64;

// Why a pixel may depend on every other; empty: none does.
std::string reaches_everywhere(const SceneFacts& facts, const FrameRequest& request, const KnobValues& knobs) {
  if (BloomPass{}.needed(facts, request)) return "bloom spreads light over all of it (--effects)";
  if (Exposure{}.needed(facts, request)) return "automatic exposure meters all of it (--effects, --exposure)";
  if (Reflections{}.needed(facts, request) && knobs.get<Reflections::Knobs>().method == Reflections::Knobs::screen)
    return "reflections look up all of it (reflections.method=traced)";
  if (Refraction{}.needed(facts, request)) return "refraction looks up all of it (--effects)";
  if (Phenomenological{}.needed(facts, request))
    return "--transparency phenomenological blurs it (--transparency sorted, layers)";
  return {};
}

// Pixels around a pixel whose shaded values or texels of light it takes: filters, and where texels are interpolated.
int filters_reach_px(const SceneFacts& facts, const FrameRequest& request, const KnobValues& knobs) {
  int reach = 4;
  const OcclusionKnobs& occlusion = knobs.get<OcclusionKnobs>();
  if (AmbientOcclusion{occlusion}.needed(facts, request)) {
    int texels = 3;  // those about a point
    if (occlusion.method == OcclusionKnobs::by_rays)
      for (int round = 0; round < occlusion.filter; ++round) texels += 2 << 2 * round;
    else
      texels += 2;
    reach += texels * occlusion.texel_px;
  }
  if (Reflections{}.needed(facts, request)) reach += 5 * knobs.get<Reflections::Knobs>().texel_px;
  if (request.draws_fog()) reach += 3 * knobs.get<FogKnobs>().march_px;
  if (VolumetricLight{}.needed(facts, request)) {
    const VolumetricLight::Knobs& light = knobs.get<VolumetricLight::Knobs>();
    reach += (light.bayer + 3) * light.texel_px;
  }
  if (request.motion_share > 0) reach += 3 * knobs.get<MotionBlur::Knobs>().most_px;
  SmoothEdges edges{.knobs = knobs.get<SmoothEdges::Knobs>()};
  if (edges.needed(facts, request)) reach += edges.knobs.reach_px + 3;
  return reach;
}

// Horizons are searched as far as the picture goes.
bool looks_up_depths_everywhere(const SceneFacts& facts, const FrameRequest& request, const KnobValues& knobs) {
  const OcclusionKnobs& occlusion = knobs.get<OcclusionKnobs>();
  return occlusion.method == OcclusionKnobs::screen && AmbientOcclusion{occlusion}.needed(facts, request);
}

}  // namespace

std::optional<PictureParts> picture_parts(const SceneFacts& facts, const FrameRequest& request, const KnobValues& knobs,
                                          std::vector<std::string>& notes) {
  if (!request.region) return std::nullopt;
  const PixelRect& region = *request.region;
  const bool told = request.part.role != SubframePart::Role::subframe;  // once for a picture of several frames
  const int width = request.width_px, height = request.height_px;
  if (const std::string why = reaches_everywhere(facts, request, knobs); !why.empty()) {
    if (told)
      notes.push_back(fmt::format("the whole picture is rendered, and the region taken from it, because {}", why));
    return std::nullopt;
  }
  const int reach = filters_reach_px(facts, request, knobs);
  PictureParts parts{.width_px = width, .height_px = height};
  parts.shaded = grown(region, reach, part_step_px, width, height);
  // The cells of neighbouring tiles, and what is looked up about a texel.
  parts.seen = grown(parts.shaded, part_step_px, part_step_px, width, height);
  std::string everywhere;
  if (looks_up_depths_everywhere(facts, request, knobs)) {
    parts.seen = {0, 0, width, height};
    everywhere = ", and depths of all of it, which occlusion.method=screen looks up";
  }
  if (told)
    notes.push_back(fmt::format("of the picture of {}x{} only {}x{} pixels about the region are shaded{}", width,
                                height, parts.shaded.width, parts.shaded.height, everywhere));
  return parts;
}

}  // namespace candela
