#include "plan/trace_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "passes/debug/tree_views.h"
#include "passes/geometry/metaballs.h"
#include "passes/occlusion/occlusion.h"
#include "passes/post/supersample.h"
#include "passes/reflections/reflections.h"
#include "passes/shadows/lamp_knobs.h"
#include "passes/shadows/light_rays.h"
#include "passes/shadows/sun_knobs.h"
#include "passes/shared/bvh_knobs.h"
#include "passes/surfaces/refraction.h"
#include "plan/trace_origin.h"

namespace candela {
namespace {

// Of lights with a size: whether shading draws their shadows soft.
bool soft_suns(const FrameData& data, const FrameSuns& suns, const SunKnobs& knobs) {
  const bool sized =
      std::ranges::any_of(data.lights, [](const LightItem& light) { return light.radius_rad > 0 && !light.is_hard; });
  return sized && (suns.traced || (suns.image && knobs.soft == SunKnobs::pcss));
}
bool soft_lamps(const SceneFacts& facts, const FrameLamps& lamps, const LampKnobs& knobs) {
  return facts.sized_lights > 0 && (lamps.traced || (lamps.image && knobs.soft == LampKnobs::pcss));
}

}  // namespace

void trace_frame(const AskedFrame& asked, const SurveyedFrame& frame, const PackedFrame& packed, const LitFrame& lit,
                 const PlanContext& context, TracedFrame& out) {
  out.rays.reset(), out.ray_settings.clear(), out.notes.clear();
  out.shift = glm::dvec3(0), out.traced = {};
  AmbientOcclusion occlusion;
  occlusion.knobs = asked.knobs.get<AmbientOcclusion::Knobs>();
  if (packed.upload.item_count == 0) return;
  const bool refraction = frame.facts.refracting_items > 0;
  Reflections reflections;
  reflections.knobs = asked.knobs.get<Reflections::Knobs>();
  Refraction refracted;
  refracted.knobs = asked.knobs.get<Refraction::Knobs>();
  out.traced.surfaces = reflections.traced(frame.facts, frame.request) || refracted.traced(frame.facts, frame.request);
  const bool shades =
      lit.suns.traced || lit.lamps.traced || occlusion.traced(frame.facts, frame.request) || out.traced.surfaces;
  const bool texels = occlusion.knobs.sends_rays() && occlusion.needed(frame.facts, frame.request);
  out.traced.tree = asked.knobs.get<BvhKnobs>();
  int& traversal = out.traced.tree.traversal;
  if (traversal == BvhKnobs::by_pipeline && frame.facts.any_relief) {
    out.notes.push_back("bvh.traversal stays at shader: the device does not know where rays meet reliefs");
    traversal = BvhKnobs::by_shader;
  }
  if (traversal == BvhKnobs::by_query && (shades || texels || packed.traces_keys)) {
    out.notes.push_back("rays ask the device what they meet: its own trees are built beside ours (bvh.traversal)");
  } else if (traversal == BvhKnobs::by_pipeline && packed.traces_keys) {
    out.notes.push_back(
        "a pipeline of the device finds what the camera's rays meet, its own trees are built beside ours; other rays "
        "go "
        "through ours (bvh.traversal)");
  } else if (traversal != BvhKnobs::by_shader) {
    if (shades || texels || shows_trees(frame.request))
      out.notes.push_back("bvh.traversal stays at shader: a pipeline sends the camera's rays alone (--technique ray)");
    traversal = BvhKnobs::by_shader;
  }
  if (shades || texels || packed.traces_keys || shows_trees(frame.request)) {
    View about = frame.view;
    about.position = trace_origin(frame.data, frame.view);
    out.shift = frame.view.position - about.position;
    const FrameData data =
        make_frame_data(context.scene, frame.pose, about, 0, {}, double(asked.knobs.get<MetaballKnobs>().cell));
    const Hash128 key =
        rays_key(context.scene, frame.pose, data, refraction, frame.request.open_sides, out.traced.tree);
    out.rays = context.rays && context.rays->key == key ? context.rays
                                                        : make_frame_rays(context.scene, frame.pose, data, refraction,
                                                                          frame.request.open_sides, out.traced.tree);
  }
  TracedRays& traced = out.traced;
  traced.soft_suns = soft_suns(frame.data, lit.suns, asked.knobs.get<SunKnobs>());
  traced.soft_lamps = soft_lamps(frame.facts, lit.lamps, asked.knobs.get<LampKnobs>());
  if (!out.rays && !traced.soft_suns && !traced.soft_lamps) return;
  const uint32_t pictures = asked.knobs.get<Supersample::Knobs>().pictures();
  const auto a_picture = [&](int count) { return (uint32_t(count) + pictures - 1) / pictures; };
  const Occlusion look = frame.request.look.occlusion.value_or(Occlusion{});
  shared::RaySettings s{};
  const bool endless = std::isinf(look.radius_m);
  s.occlusion_radius_m = endless ? std::numeric_limits<float>::max() : float(look.radius_m);
  s.occlusion_fade_m = endless ? 0 : std::max(float(look.falloff * look.radius_m), 1e-6f * s.occlusion_radius_m);
  s.occlusion_strength = float(look.strength);
  s.occlusion_rays = traced.occlusion_rays = a_picture(occlusion.knobs.rays);
  s.sun_samples = traced.sun_samples = a_picture(asked.knobs.get<SunKnobs>().samples);
  s.lamp_samples = traced.lamp_samples = a_picture(asked.knobs.get<LampKnobs>().samples);
  s.seed = frame.request.still_seed;
  if (shades || texels || traced.soft_suns || traced.soft_lamps) out.ray_settings.push_back(s);
  if (!out.rays) return;
  // Rounded up, so that frames whose trees differ a little share their pipelines.
  traced.stack = (out.rays->stack + 7) / 8 * 8;
  traced.blended = out.rays->blended;
  traced.suns = lit.suns.traced, traced.lamps = lit.lamps.traced;
  const int apart = asked.knobs.get<LightRayKnobs>().apart;
  traced.lockstep = context.cpu;
  traced.lights_apart = apart == LightRayKnobs::always || (apart == LightRayKnobs::by_device && !context.cpu);
  // Cells know their light by triangles alone.
  const bool by_voxels = !frame.facts.any_relief;
  traced.suns_by_voxels = by_voxels && lit.suns.by_voxels, traced.lamps_by_voxels = by_voxels && lit.lamps.by_voxels;
  if (!by_voxels && (lit.suns.by_voxels || lit.lamps.by_voxels))
    out.notes.push_back("voxels are left out: the scene has reliefs, and every ray is sent");
}

}  // namespace candela
