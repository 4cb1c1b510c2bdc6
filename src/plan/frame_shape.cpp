#include "plan/frame_shape.h"

#include <bit>

#include "passes/debug/tree_views.h"
#include "plan/plan_frame.h"

namespace candela {
namespace {

void take_maps(const ShadowMaps& maps, bool by_regions, bool in_compute, FrameShape::Maps& shape) {
  shape.sizes_and_layers.clear(), shape.regions.clear(), shape.rounds.clear();
  shape.commands = 0;
  if (!maps.image) {
    shape.name.clear();
    shape.size_px = shape.layers = shape.texel_layers = shape.most_px = shape.room = 0;
    shape.apart = shape.outlives = shape.in_parts = false;
    return;
  }
  const ViewImage& image = *maps.image;
  shape.name = image.name;
  shape.size_px = image.size_px, shape.layers = image.layers;
  shape.texel_layers = in_compute ? image.texel_layers : 0;  // of compute's rasterizer alone
  shape.most_px = image.most_px, shape.room = image.room();
  shape.apart = image.apart, shape.outlives = image.outlives, shape.in_parts = image.in_parts;
  const std::vector<uint32_t>& first = maps.views.first_command;
  shape.commands = std::bit_ceil(std::max<uint64_t>({first.empty() ? 0 : first.back(), image.commands, 1}));
  if (!in_compute) view_rounds(image, shape.rounds);
  for (const shared::View& view : image.views)
    if (!image.apart) shape.sizes_and_layers.emplace_back(view.size_px.x, view.layer);
  for (size_t r = 0; by_regions && r + 1 < first.size(); ++r) shape.regions.push_back(first[r] < first[r + 1]);
}

// What declarations ask of a look.
void take_look(const Look& look, Look& shape) {
  const auto one = [](bool is_any) { return glm::dvec3(is_any ? 1 : 0); };
  shape.fog.reset(), shape.more_fog.clear();
  if (look.fog) {
    shape.fog.emplace();
    shape.fog->extinction_per_m = one(true);
    shape.fog->scattering_per_m = one(fog_scatters(look));
    shape.fog->emission_per_m = one(fog_glows(look));
    shape.fog->turn_rad = summed_fog(look) == 1 ? 1 : 0;
    shape.more_fog.resize(look.more_fog.size());
  }
  if (look.bloom) {
    if (!shape.bloom) shape.bloom.emplace();
    shape.bloom->weights.assign(look.bloom->weights.size(), 1);
    shape.bloom->in_beauty = look.bloom->in_beauty, shape.bloom->of_emission = look.bloom->of_emission;
  } else {
    shape.bloom.reset();
  }
  const auto whether = [](const auto& is_there, auto& there) {
    if (!is_there)
      there.reset();
    else if (!there)
      there.emplace();
  };
  whether(look.exposure.automatic, shape.exposure.automatic);
  whether(look.occlusion, shape.occlusion);
  whether(look.reflections, shape.reflections);
  whether(look.volumetric, shape.volumetric);
  shape.probes.resize(look.probes.size());
}

void take_request(const FrameRequest& request, FrameRequest& shape) {
  // Copied into what the shape has: its look is put aside, for it is not that of the frame.
  Look look = std::move(shape.look);
  FrameRequest& copy = shape;
  copy.width_px = request.width_px, copy.height_px = request.height_px, copy.region = request.region;
  copy.samples = request.samples;
  copy.want_linear = request.want_linear, copy.want_display = request.want_display;
  copy.for_files = request.for_files, copy.exr_float = request.exr_float;
  copy.look_nonfinite = request.look_nonfinite, copy.shows_through = request.shows_through;
  copy.behind_rgb = request.behind_rgb, copy.sky_hidden = request.sky_hidden;
  copy.layers = request.layers, copy.light_groups = request.light_groups;
  copy.view = request.view, copy.view_is_light = request.view_is_light, copy.view_alone = request.view_alone;
  copy.technique = request.technique, copy.transparency = request.transparency, copy.tonemap = request.tonemap;
  copy.display_bits = request.display_bits, copy.dither = request.dither, copy.still_seed = request.still_seed;
  copy.quality = request.quality, copy.open_sides = request.open_sides, copy.effects = request.effects;
  copy.part = request.part;
  copy.part.index = 0, copy.part.offset_px = glm::dvec2(0);
  copy.motion_share = request.motion_share > 0 ? 1 : 0;
  copy.neutral_light = request.neutral_light;
  copy.look = std::move(look);
  take_look(request.look, copy.look);
}

FrameShape::Kept kept_of(const std::optional<Hash128>& key, const PlanContext& context) {
  if (!key || !context.kept) return FrameShape::Kept::no;
  if (context.kept->filled.contains(*key)) return FrameShape::Kept::filled;
  return context.kept->seen.contains(*key) ? FrameShape::Kept::seen : FrameShape::Kept::unknown;
}

}  // namespace

void take_shape(const AskedFrame& asked, const PlannedFrame& f, const PlanContext& context,
                std::span<const UploadRow> rows, const std::optional<PictureParts>& parts, FrameShape& shape) {
  const FrameUpload& u = f.upload;
  shape.technique = asked.technique;
  shape.knobs = asked.knobs;
  take_request(f.request, shape.request);
  shape.facts = f.facts;
  for (uint32_t SceneFacts::*lights : {&SceneFacts::point_lights, &SceneFacts::spot_lights,
                                       &SceneFacts::directional_lights, &SceneFacts::sized_lights})
    shape.facts.*lights = std::min(shape.facts.*lights, 1u);
  shape.batches = f.draws.batches;
  take_maps(f.suns, f.shadow_colors, u.batch_count > 0, shape.suns);
  take_maps(f.lamps, f.shadow_colors, u.batch_count > 0, shape.lamps);
  shape.parts = parts;
  shape.pool.reset();
  if (f.lamps.pool) shape.pool = {f.lamps.pool->layer_px, f.lamps.pool->layers, !f.lamps.pool->fresh};
  shape.rows.clear();
  for (const UploadRow& row : rows) shape.rows.push_back({row.name, row.input, row.size_bytes, row.to_fill});

  SceneInputs& s = shape.scene;
  s.light_grid = f.light_grid.shape;
  s.sun_absence = f.suns.absence, s.lamp_absence = f.lamps.absence;
  s.sun_key.reset(), s.lamp_key.reset();
  shape.suns_kept = kept_of(f.sun_key, context), shape.lamps_kept = kept_of(f.lamp_key, context);
  s.rays = f.traced;
  s.tree_ranges = f.rays && shows_trees(f.request) ? f.rays->ranges : nullptr;
  s.item_count = u.item_count, s.light_room = light_room(u.constants.light_count);
  s.item_group_count = uint32_t(u.item_groups.size()), s.item_span_count = uint32_t(u.item_spans.size());
  s.batch_span_count = uint32_t(u.batch_spans.size()), s.transform_count = u.transform_count;
  s.light_group_count = uint32_t(u.light_groups.size());
  s.metaball_body_count = uint32_t(u.metaball_bodies.size());
  s.metaball_block_room = std::bit_ceil(std::max(uint32_t(u.metaball_blocks.size()), 1u));
  const glm::vec4& background = u.constants.background;
  s.background = {background.x, background.y, background.z, background.w};
  s.cull_group_count = uint32_t(u.groups.size());
  s.batch_count = u.batch_count;
  s.deform_vertices.clear();
  for (const shared::DeformJob& job : u.deform_jobs) s.deform_vertices.push_back(job.vertex_count);
  s.deformed_words = u.deformed_words;
  s.open_sides = f.request.open_sides;
  s.width_px = uint32_t(f.request.width_px), s.height_px = uint32_t(f.request.height_px);
  s.samples = uint32_t(f.request.samples);
  s.stores_samples = f.stores_samples;
}

}  // namespace candela
