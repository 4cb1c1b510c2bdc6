#include "passes/shadows/light_rays.h"

#include <algorithm>

#include "passes/shared/draw_batches.h"
#include "passes/shared/features.h"
#include "shared/lobes.h"

namespace candela {
namespace {

// As shaders/lib/light_records.glsl has them.
constexpr uint32_t group_px = 8, head_words = 2, most_subgroups = 16;
struct Rooms {
  uint64_t groups = 0, bytes = 0;
  uint32_t words = 0;    // of a group's
  bool suffice = false;  // whatever is recorded
};
Rooms rooms_of(const SceneInputs& s, const TracedRays& rays, const LightRayKnobs& knobs) {
  Rooms out;
  const auto side = [](uint32_t px) { return uint64_t(px + group_px - 1) / group_px; };
  out.groups = side(s.width_px) * side(s.height_px);
  const uint64_t samples = std::max(
      {rays.suns && rays.soft_suns ? rays.sun_samples : 1, rays.lamps && rays.soft_lamps ? rays.lamp_samples : 1});
  const uint64_t a_ray = rays.blended ? group_px * group_px : most_subgroups;
  const uint64_t all =
      s.samples * (s.light_room * (samples * a_ray + most_subgroups * head_words) + 2 * most_subgroups);
  const uint64_t fitting = (uint64_t(knobs.budget_mb) << 18) / out.groups;
  // How a GPU forms subgroups is known in the shader alone.
  out.suffice = rays.lockstep && all <= fitting;
  out.words = uint32_t(std::min<uint64_t>({std::max<uint64_t>(std::min(all, fitting), most_subgroups), 1u << 24}));
  out.bytes = (1 + out.groups) * 256 + out.groups * out.words * 4;
  return out;
}

}  // namespace

std::span<const Knob> LightRayKnobs::table() {
  constexpr std::string_view in_use = "local.method=traced sun.mode=traced";
  static const Knob rows[] = {
      {.name = "apart",
       .member = &LightRayKnobs::apart,
       .lowest = 0,
       .highest = 2,
       .levels = {by_device},
       .description = "whether rays to lights are sent by a pass of their own before surfaces are shaded; auto: on a "
                      "GPU. The picture is the same",
       .choices = {"off", "auto", "on"},
       .kind = Trades::time,
       .sweep = {0, 2, 1},
       .required = in_use},
      {.name = "budget_mb",
       .member = &LightRayKnobs::budget_mb,
       .unit = "MB",
       .lowest = 1,
       .highest = 16384,
       .levels = {256, 256, 256, 1024},
       .description = "most memory for what such rays find; pixels without room send their own as they are shaded",
       .kind = Trades::time,
       .sweep = {16, 64, 256, 1024},
       .required = in_use},
  };
  return rows;
}

Need LightRays::needed(const SceneFacts& facts, const FrameRequest&) const {
  const bool suns = rays.suns && !rays.suns_by_voxels, lamps = rays.lamps && !rays.lamps_by_voxels;
  if (!suns && !lamps) return {false, "no light's shadows are traced (local.method, sun.mode)"};
  if (rays.suns_by_voxels || rays.lamps_by_voxels)
    return {false, "cells of the view know some lights' shadows: shading sends the rays that they leave"};
  if (lists_have_a_cap) return {false, "lists of lights have a cap (lights.cap): shading sends the rays itself"};
  if ((facts.lobes & shared::lobe_scattering) != 0)
    return {false, "bodies scatter light: rays begin where it enters them, which shading knows"};
  if (!rays.lights_apart) return {false, "shading sends the rays itself (light_rays.apart)"};
  return needed_for_solid_surfaces(facts);
}

LightRays::Out LightRays::declare(GraphBuilder& builder, const In& in) const {
  const SceneInputs& s = in.scene;
  const Lighting& lists = in.lists;
  declare_keyed_surfaces(builder, s, in.keys, in.deformed);
  declare_lights(builder, s, lists, ReadBy::compute());
  const Rooms rooms = rooms_of(s, in.lists.rays, knobs);
  Out out;
  out.records.suffice = rooms.suffice;
  out.records.words = builder.write(builder.create(BufferDesc{"light.records", rooms.bytes}), Access::compute_write);
  ComputePipelineDesc desc{"light_rays.comp", light_constants(lists)};
  desc.constants.insert(desc.constants.end(), s.features.begin(), s.features.end());
  desc.constants.push_back({30, "SAMPLES", s.samples});
  desc.shader += surface_definitions(desc.constants);
  if (in.lists.rays.lockstep) desc.shader += "#LOCKSTEP=1";
  out.pipeline = builder.pipeline(desc);
  return out;
}

void LightRays::record(CommandList& commands, const In& in, const Out& out) const {
  OwnInputs own;
  own.table = in.keys;
  own.deformed_before = out.records.words;
  own.number = rooms_of(in.scene, in.lists.rays, knobs).words;
  commands.bind(out.pipeline);
  shared::DrawPush push = draw_push(commands, in.scene, in.deformed, &in.lists, nullptr, own);
  const glm::uvec2 first = commands.first_group();
  push.occlusion = first.x | first.y << 16;  // whose group writes what all records begin with
  commands.push(push);
  commands.dispatch_picture(in.scene.width_px, in.scene.height_px);
}

}  // namespace candela
