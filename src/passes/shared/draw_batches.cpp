#include "passes/shared/draw_batches.h"

#include <algorithm>

#include "passes/shared/features.h"
#include "passes/shared/push_lights.h"
#include "shared/draw.h"
#include "shared/visibility.h"

namespace candela {
namespace {
VkPrimitiveTopology vulkan_topology(Topology t) {
  return t == Topology::triangles ? VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST
         : t == Topology::lines   ? VK_PRIMITIVE_TOPOLOGY_LINE_LIST
                                  : VK_PRIMITIVE_TOPOLOGY_POINT_LIST;
}
bool traces(const Lighting& lists) {
  const bool to_lights = (lists.rays.suns || lists.rays.lamps) && !(lists.records.words && lists.records.suffice);
  return lists.rays.trees && (to_lights || lists.rays.surfaces || lists.occlusion.traced);
}
bool takes_settings(const Lighting& lists) {
  return lists.rays.settings && (traces(lists) || lists.records.words || lists.rays.soft_suns || lists.rays.soft_lamps);
}
// Its fragments have the depth of what they show. Behind a pre-pass that has drawn the same, roundings may part the
// two: they are drawn a little before it instead of at the same depth.
void draw_relief(GraphicsPipelineDesc& desc) {
  const bool behind_prepass = desc.depth_compare == VK_COMPARE_OP_EQUAL;
  if (behind_prepass) desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  desc.vertex_shader += "#RELIEF=1";
  desc.fragment_shader += fmt::format("#RELIEF={}", behind_prepass ? 2 : 1);
  if (desc.samples == 1) return;
  desc.fragment_shader += fmt::format("#RELIEF_SAMPLES={}", desc.samples);
  if (has_reliefs_of_samples(desc.constants)) desc.fragment_shader += "#RELIEF_BY_SAMPLE=1";
}
}  // namespace

BatchPipelines declare_batches(GraphBuilder& builder, const SceneInputs& scene, const Draws& draws,
                               BufferHandle deformed, const std::function<bool(const DrawBatch&)>& accepts,
                               const BatchPipelineChoice& choice) {
  builder.read(scene.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {scene.vertices, scene.items, scene.transforms, scene.geometries, scene.materials})
    builder.read(b, Access::graphics_read, "the scene");
  builder.read(scene.indices, Access::index_read, "the scene's indices");
  builder.read(draws.commands, Access::indirect_read, "draw commands");
  builder.read(draws.counts, Access::indirect_read, "draw counts");
  builder.read_optional(scene.lobes, Access::graphics_read);
  builder.read_optional(deformed, Access::vertex_read);
  BatchPipelines pipelines;
  bool any_relief = false;
  for (const DrawBatch& run : *scene.draw_batches) any_relief |= run.relief && accepts(run);
  if (any_relief) {
    // Their fragments take the triangle's corners themselves.
    builder.read(scene.indices, Access::graphics_read, "the scene's indices");
    builder.read_optional(deformed, Access::graphics_read);
  }
  for (const DrawBatch& run : *scene.draw_batches) {
    if (!accepts(run)) {
      pipelines.by_run.push_back({});
      continue;
    }
    GraphicsPipelineDesc desc = choice.desc;
    desc.topology = vulkan_topology(run.topology);
    const bool masked = run.alpha == AlphaMode::mask;
    if (masked && !choice.masked_fragment.empty()) desc.fragment_shader = choice.masked_fragment;
    if (run.relief && !choice.relief_fragment.empty()) desc.fragment_shader = choice.relief_fragment;
    desc.constants = run_constants(scene.features, desc, masked, run.unlit);
    if (!run.relief && !sends_rays(desc.constants)) leave_out_reliefs(desc.constants);
    desc.fragment_shader += surface_definitions(desc.constants);
    if (scatters_in_bodies(desc.constants)) desc.vertex_shader += "#SCATTERS=1";
    if (rounds_off(desc.constants)) desc.vertex_shader += "#ROUNDED=1";
    if (run.relief) draw_relief(desc);
    pipelines.by_run.push_back(builder.pipeline(desc));
  }
  return pipelines;
}

bool draws_lines(const SceneInputs& scene) {
  return std::ranges::any_of(*scene.draw_batches, [](const DrawBatch& r) { return r.solid() && r.is_lines(); });
}

void declare_lights(GraphBuilder& builder, const SceneInputs& scene, const Lighting& lists, const ReadBy& by) {
  for (const BufferHandle b : {scene.lights, scene.light_globals, lists.cells, lists.entries, lists.tiles})
    builder.read_optional(b, by.buffer);
  builder.read_optional(lists.occlusion.open, by.image);
  if (lists.sun_maps) {
    builder.read(lists.sun_maps, by.image, "the suns' maps");
    builder.read(scene.suns, by.buffer, "the suns' cascades");
  }
  if (lists.lamp_maps) {
    builder.read(lists.lamp_maps, by.image, "the local lights' maps");
    builder.read(scene.lamps, by.buffer, "the local lights' tiles");
  }
  for (const ImageHandle shadows :
       {lists.shadow_colors.suns, lists.shadow_colors.lamps, lists.deep.suns, lists.deep.lamps})
    builder.read_optional(shadows, by.image);
  const TracedRays& rays = lists.rays;
  if (traces(lists)) {
    builder.read(rays.trees, by.buffer, "the trees for rays");
    for (const Knob& row : BvhKnobs::table())
      builder.knob(fmt::format("{}.{}", BvhKnobs::name, row.name), row.text(row.value(&rays.tree)));
  }
  if (takes_settings(lists)) builder.read(rays.settings, by.buffer, "how rays are sent");
  builder.read_optional(lists.voxels.states, by.buffer);
  builder.read_optional(lists.records.words, by.buffer);
  const auto count = [&](bool used, const char* knob, uint32_t value) {
    if (used) builder.knob(knob, fmt::format("{} a picture", value));
  };
  count(lists.occlusion.traced, "occlusion.rays", rays.occlusion_rays);
  count(rays.soft_suns, "sun.samples", rays.sun_samples);
  count(rays.soft_lamps, "local.samples", rays.lamp_samples);
}

std::string with_shadow_colors(std::string shader, const ShadowColors& colors) {
  if (!colors.suns && !colors.lamps) return shader;
  return shader +
         fmt::format("#COLORED_SHADOWS={}", (colors.suns ? 1 : 0) + (colors.lamps ? 2 : 0) + (colors.bent ? 4 : 0));
}

std::string with_deep_shadows(std::string shader, const Lighting& lists) {
  const int kinds = (lists.deep.suns && !lists.rays.suns ? 1 : 0) + (lists.deep.lamps && !lists.rays.lamps ? 2 : 0);
  return kinds == 0 ? shader : shader + fmt::format("#DEEP_SHADOWS={}", kinds);
}

std::vector<SpecConstant> light_constants(const Lighting& lists) {
  std::vector<SpecConstant> constants;
  const TracedRays& rays = lists.rays;
  if (lists.sun_maps || rays.suns) constants.push_back(sun_shadows_constant(rays.suns, rays.soft_suns));
  if (lists.occlusion.open || lists.occlusion.traced)
    constants.push_back(occlusion_constant(lists.occlusion.shape, lists.occlusion.traced));
  if (lists.lamp_maps || rays.lamps) constants.push_back(lamp_shadows_constant(rays.lamps, rays.soft_lamps));
  // How wide records of rays are.
  if (!traces(lists) && lists.records.words && rays.blended) constants.push_back(rays_meet_blended_constant());
  if (!traces(lists)) return constants;
  const std::vector<SpecConstant> more =
      ray_constants(rays.stack, rays.blended, rays.tree.traversal == BvhKnobs::by_query);
  constants.insert(constants.end(), more.begin(), more.end());
  if (lists.voxels.states)
    constants.push_back(light_voxels_constant(rays.suns_by_voxels, rays.lamps_by_voxels, lists.voxels.halve));
  return constants;
}

void declare_keyed_surfaces(GraphBuilder& builder, const SceneInputs& s, BufferHandle keys, BufferHandle deformed) {
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {s.vertices, s.indices, s.items, s.transforms, s.geometries, s.materials, s.batches})
    builder.read(b, Access::compute_read, "the scene");
  builder.read(keys, Access::compute_read, "keys");
  builder.read_optional(s.lobes, Access::compute_read);
  builder.read_optional(deformed, Access::compute_read);
}

void declare_met_surfaces(GraphBuilder& builder, const SceneInputs& s, BufferHandle deformed, const Lighting& met) {
  builder.read(s.constants, Access::uniform_read, "the frame's constants");
  for (const BufferHandle b : {s.vertices, s.indices, s.items, s.transforms, s.geometries, s.materials, s.drawn_items})
    builder.read(b, Access::compute_read, "the scene");
  builder.read_optional(s.lobes, Access::compute_read);
  builder.read_optional(deformed, Access::compute_read);
  declare_lights(builder, s, met, ReadBy::compute());
  declare_fog(builder, s, met, true, ReadBy::compute());
}

std::vector<SpecConstant> met_constants(const SceneInputs& scene, const Lighting& met) {
  std::vector<SpecConstant> constants = light_constants(met);
  constants.insert(constants.end(), scene.features.begin(), scene.features.end());
  return constants;
}

NearestSurface declare_nearest_surface(GraphBuilder& builder, const SceneInputs& scene, const Draws& draws,
                                       BufferHandle deformed, std::string_view pass, std::string fragment_shader,
                                       std::vector<VkFormat> color_formats, std::vector<SpecConstant> constants,
                                       std::string vertex_shader) {
  BatchPipelineChoice choice;
  choice.desc.vertex_shader = std::move(vertex_shader);
  choice.desc.fragment_shader = std::move(fragment_shader);
  choice.desc.color_formats = std::move(color_formats);
  choice.desc.depth_format = depth_format;
  choice.desc.depth_test = choice.desc.depth_write = true;
  choice.desc.depth_compare = VK_COMPARE_OP_GREATER_OR_EQUAL;
  choice.desc.constants = std::move(constants);
  NearestSurface out;
  out.pipelines = declare_batches(
      builder, scene, draws, deformed, [](const DrawBatch& r) { return r.alpha != AlphaMode::blend; }, choice);
  out.depth =
      builder.write(builder.create(ImageDesc{std::string(pass) + ".z", depth_format, scene.width_px, scene.height_px}),
                    Access::depth_attachment);
  return out;
}

GraphicsPipelineDesc samples_pipeline(std::string fragment_shader, uint32_t samples) {
  GraphicsPipelineDesc desc;
  desc.vertex_shader = "background.vert";
  desc.fragment_shader = std::move(fragment_shader);
  if (samples > 1) desc.constants = {{0, "SAMPLES", samples}};
  desc.samples = samples;
  return desc;
}

void record_samples(CommandList& commands, PipelineHandle pipeline, const shared::SamplesPush& push, uint32_t tiles) {
  commands.bind(pipeline);
  commands.set_cull(false, false);
  commands.push(push);
  commands.draw(tiles > 0 ? 6 : 3, tiles > 0 ? tiles : 1);
}

ImageHandle write_color(GraphBuilder& builder, const SceneInputs& scene, ImageHandle color) {
  if (!color) {
    ImageDesc desc{"color", color_format, scene.width_px, scene.height_px, scene.samples};
    desc.covered = true;
    color = builder.create(desc);
  }
  return builder.write(color, Access::color_attachment);
}

namespace {
// Into the members that DrawPush and SkyPush share.
template <class Push>
void push_lights(CommandList& commands, const SceneInputs& scene, const Lighting* lists, const Lighting* fog,
                 Push& push) {
  if (fog && fog_is_read(*fog)) push.fog_light = commands.sampled(fog->fog.grid);
  if (!lists && fog && fog_walks(*fog)) lists = fog;
  if (lists) push_light_lists(commands, scene, *lists, push);
}
}  // namespace

shared::SkyPush sky_push(CommandList& commands, const SceneInputs& scene, const Lighting& lists) {
  shared::SkyPush push{};
  push.subsample_ndc = scene.subsample_ndc();
  push.subsample_footprint = scene.subsample_footprint;
  push_lights(commands, scene, nullptr, &lists, push);
  return push;
}

shared::DrawPush draw_push(CommandList& commands, const SceneInputs& scene, BufferHandle deformed,
                           const Lighting* lists, const Lighting* fog, const OwnInputs& own) {
  shared::DrawPush push{};
  push.table = own.table ? commands.address(own.table) : own.word;
  push.own = own.number;
  if (own.deformed_before) push.deformed_before = commands.address(own.deformed_before);
  push.subsample_ndc = scene.subsample_ndc();
  push.subsample_footprint = scene.subsample_footprint;
  push.deformed = deformed ? commands.address(deformed) : 0;
  push_lights(commands, scene, lists, fog, push);
  if (lists && lists->shadow_colors.suns) push.shadow_colors |= image_place(commands, lists->shadow_colors.suns);
  if (lists && lists->shadow_colors.lamps)
    push.shadow_colors |= image_place(commands, lists->shadow_colors.lamps) << 16;
  if (lists && lists->occlusion.open) push.occlusion = commands.sampled(lists->occlusion.open);
  if (lists && traces(*lists)) push.trees = commands.address(lists->rays.trees);
  if (lists && takes_settings(*lists)) {
    // Cells and records begin with the settings.
    push.rays = commands.address(lists->voxels.states   ? lists->voxels.states
                                 : lists->records.words ? lists->records.words
                                                        : lists->rays.settings);
    push.subsample = scene.subsample();
  }
  return push;
}

void record_batches(CommandList& commands, const SceneInputs& scene, const Draws& draws, BufferHandle deformed,
                    const BatchPipelines& pipelines, const Lighting* lists, const Lighting* fog, const OwnInputs& own) {
  commands.bind_index_buffer(scene.indices);
  const shared::DrawPush push = draw_push(commands, scene, deformed, lists, fog, own);
  for (size_t r = 0; r < scene.draw_batches->size(); ++r) {
    if (!pipelines.by_run[r]) continue;
    const DrawBatch& run = (*scene.draw_batches)[r];
    commands.bind(pipelines.by_run[r]);
    commands.push(push);
    commands.set_cull(run.cull_back || own.backs, run.mirrored != own.backs);
    commands.draw_indexed_indirect_count(draws.commands, uint64_t(run.first) * sizeof(shared::DrawCommand),
                                         draws.counts, own.first_count + r * sizeof(uint32_t), run.count);
  }
}

void record_view_depth(CommandList& commands, const SceneInputs& scene, const Draws& draws, BufferHandle deformed,
                       const BatchPipelines& pipelines, uint32_t number, const shared::View& view) {
  shared::DepthViewPush push{};
  push.deformed = deformed ? commands.address(deformed) : 0;
  push.clip_from_relative = view.clip_from_relative;
  push.flattens = view.flags & shared::view_is_perspective ? 0 : 1;
  record_view_runs(commands, scene, draws, pipelines, number, push, scene.open_sides);
}

}  // namespace candela
