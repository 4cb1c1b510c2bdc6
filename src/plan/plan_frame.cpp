#include "plan/plan_frame.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <numbers>

#include "base/clock.h"
#include "base/log.h"
#include "base/text.h"
#include "job/background.h"
#include "job/choose_transparency.h"
#include "job/frame_knobs.h"
#include "job/job_look.h"
#include "job/not_drawn.h"
#include "passes/geometry/features.h"
#include "plan/caster_hash.h"
#include "plan/device_pose.h"
#include "plan/frame_fog.h"
#include "plan/posed_scene.h"
#include "plan/probe_image.h"
#include "plan/upload_table.h"
#include "scene/neutral_light.h"
#include "techniques/technique.h"

namespace candela {
namespace {

std::array<float, 4> exposed(const BackgroundChoice& background, float pre_exposure) {
  const auto& [r, g, b, a] = background.linear;
  return {r * pre_exposure, g * pre_exposure, b * pre_exposure, a};
}

// How far what is drawn lies from the camera: along the view axis, and in all, which only orthographic views ask.
// Infinite where bounds are unknown.
struct DrawnExtent {
  double farthest_m = 0, reach_m = 0;
};
DrawnExtent drawn_extent(const Scene& scene, const FrameData& data, const View& view) {
  DrawnExtent extent;
  const glm::dvec3 forward = -glm::dvec3(glm::transpose(view.view_from_relative)[2]);
  const auto depth = [&](const auto& box) {
    return glm::dot(glm::dvec3(box.centre()), forward) + glm::dot(glm::dvec3(box.extent()), glm::abs(forward));
  };
  const auto reach = [](const auto& box) {
    return glm::length(glm::dvec3(box.centre())) + glm::length(glm::dvec3(box.extent()));
  };
  for (const DrawItem& item : data.items) {
    const double item_depth = depth(item.bounds_relative), item_reach = reach(item.bounds_relative);
    if (!std::isfinite(item_depth + item_reach))
      return {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    extent.farthest_m = std::max(extent.farthest_m, item_depth);
    extent.reach_m = std::max(extent.reach_m, item_reach);
  }
  extent.farthest_m = std::max(extent.farthest_m, largest_score(scene, data, depth, depth));
  if (view.perspective) return extent;
  // A box within another one: its centre's distance and its own half diagonal are at most sqrt(2) of the other's half.
  const auto most_reach = [](const DAabb& box) {
    return glm::length(box.centre()) + std::numbers::sqrt2 * glm::length(box.extent());
  };
  extent.reach_m = std::max(extent.reach_m, largest_score(scene, data, most_reach, reach));
  return extent;
}

// Between which depths along the view axis surfaces lie that are seen through, as far as they are before the camera.
std::pair<float, float> blended_depths(const FrameData& data, const DrawList& draws, const View& view) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = view.near_m;
  const glm::dvec3 forward = -glm::dvec3(glm::transpose(view.view_from_relative)[2]);
  const uint32_t grouped = draws.item_count() - uint32_t(draws.order.size());  // all of them come before
  for (const DrawRun& run : draws.runs) {
    if (run.solid()) continue;
    for (uint32_t i = run.first; i < run.first + run.count; ++i) {
      const Aabb& bounds = data.items[draws.order[i - grouped]].bounds_relative;
      const double middle = glm::dot(glm::dvec3(bounds.centre()), forward);
      const double half = glm::dot(glm::dvec3(bounds.extent()), glm::abs(forward));
      const bool known = std::isfinite(middle) && std::isfinite(half);
      nearest = std::min(nearest, known ? middle - half : view.near_m);
      farthest = std::max(farthest, known ? middle + half : view.near_m * 0x1p20);
    }
  }
  nearest = std::max(nearest, view.near_m);
  return {float(nearest), float(std::max(farthest, nearest))};
}

// Of lights with a size: whether shading draws their shadows soft.
bool soft_suns(const PlannedFrame& f, const SunKnobs& knobs) {
  const bool sized = f.request.look.sun && f.request.look.sun->angular_radius_deg > 0;
  return sized && (f.suns.traced || (f.suns.image && knobs.soft == SunKnobs::pcss));
}
bool soft_lamps(const PlannedFrame& f, const LampKnobs& knobs) {
  return f.facts.sized_lights > 0 && (f.lamps.traced || (f.lamps.image && knobs.soft == LampKnobs::pcss));
}

// Trees, where shading sends rays, and how it does.
void plan_rays(PlannedFrame& f, const PlanContext& context, const KnobValues& knobs, bool traces_keys) {
  AmbientOcclusion occlusion;
  occlusion.knobs = knobs.get<AmbientOcclusion::Knobs>();
  if (f.upload.item_count == 0) return;
  const bool refraction = f.facts.refracting_items > 0;
  Reflections reflections;
  reflections.knobs = knobs.get<Reflections::Knobs>();
  Refraction refracted;
  refracted.knobs = knobs.get<Refraction::Knobs>();
  f.traced.surfaces = reflections.traced(f.facts, f.request) || refracted.traced(f.facts, f.request);
  const bool shades = f.suns.traced || f.lamps.traced || occlusion.traced(f.facts, f.request) || f.traced.surfaces;
  f.traced.tree = knobs.get<BvhKnobs>();
  int& traversal = f.traced.tree.traversal;
  if (traversal == BvhKnobs::by_query && (shades || traces_keys)) {
    f.notes.push_back("rays ask the device what they meet: its own trees are built beside ours (bvh.traversal)");
  } else if (traversal == BvhKnobs::by_pipeline && traces_keys) {
    f.notes.push_back(
        "a pipeline of the device finds what the camera's rays meet, its own trees are built beside ours; other rays "
        "go "
        "through ours (bvh.traversal)");
  } else if (traversal != BvhKnobs::by_shader) {
    if (shades || shows_trees(f.request))
      f.notes.push_back("bvh.traversal is left at shader: a pipeline sends the camera's rays alone (--technique ray)");
    traversal = BvhKnobs::by_shader;
  }
  if (shades || traces_keys || shows_trees(f.request))
    f.rays = context.rays && context.rays->key == rays_key(context.scene, f.pose, f.data, refraction, f.traced.tree)
                 ? context.rays
                 : make_frame_rays(context.scene, f.pose, f.data, refraction, f.traced.tree);
  TracedRays& traced = f.traced;
  traced.soft_suns = soft_suns(f, knobs.get<SunKnobs>());
  traced.soft_lamps = soft_lamps(f, knobs.get<LampKnobs>());
  if (!f.rays && !traced.soft_suns && !traced.soft_lamps) return;
  const uint32_t pictures = knobs.get<Supersample::Knobs>().pictures();
  const auto a_picture = [&](int count) { return (uint32_t(count) + pictures - 1) / pictures; };
  const Occlusion look = f.request.look.occlusion.value_or(Occlusion{});
  shared::RaySettings s{};
  s.occlusion_radius_m = float(look.radius_m);
  s.occlusion_fade_m = std::max(float(look.falloff * look.radius_m), 1e-6f * s.occlusion_radius_m);
  s.occlusion_strength = float(look.strength);
  s.occlusion_rays = traced.occlusion_rays = a_picture(occlusion.knobs.rays);
  s.sun_samples = traced.sun_samples = a_picture(knobs.get<SunKnobs>().samples);
  s.lamp_samples = traced.lamp_samples = a_picture(knobs.get<LampKnobs>().samples);
  if (traced.soft_suns) {
    const double angle = glm::radians(f.request.look.sun->angular_radius_deg);
    s.sun_height = float(2 * std::pow(std::sin(angle / 2), 2));
    s.sun_tangent = float(std::tan(angle));
  }
  s.seed = f.request.still_seed;
  if (shades || traced.soft_suns || traced.soft_lamps) f.ray_settings = {s};
  if (!f.rays) return;
  // Rounded up, so that frames whose trees differ a little share their pipelines.
  traced.stack = (f.rays->stack + 7) / 8 * 8;
  traced.blended = f.rays->blended;
  traced.suns = f.suns.traced, traced.lamps = f.lamps.traced;
  traced.suns_by_voxels = f.suns.by_voxels, traced.lamps_by_voxels = f.lamps.by_voxels;
  if (traced.surfaces) add_drawn_items(f.draws, f.upload);
}

// Imports every buffer that the frame has content for.
SceneInputs import_scene(GraphBuilder& builder, const PlanContext& context, PlannedFrame& f) {
  const FrameUpload& u = f.upload;
  SceneInputs s;
  for (const UploadRow& row : upload_table(f, context.layout)) {
    f.imports.push_back(-1);
    if (row.size_bytes == 0) continue;
    s.*row.input = builder.import_buffer(BufferDesc{row.name, row.size_bytes},
                                         row.to_fill ? GraphBuilder::Import::to_fill : GraphBuilder::Import::filled);
    f.imports.back() = (s.*row.input).resource;
  }
  s.light_grid = f.light_grid.shape;
  s.sun_image = f.suns.image;
  s.sun_absence = f.suns.absence;
  // With coloured shadows all views are culled anew anyway, and what is kept tells nothing of see-through surfaces.
  if (context.kept && !f.shadow_colors && (s.sun_image || f.lamps.image))
    if (const auto casters = caster_hash(f.draws, u, f.pose, f.textures)) {
      if (s.sun_image) s.sun_key = depth_views_key(*casters, *s.sun_image);
      if (f.lamps.image) s.lamp_key = depth_views_key(*casters, *f.lamps.image);
    }
  s.view_first_command = std::make_shared<const std::vector<uint32_t>>(f.suns.views.first_command);
  s.lamp_image = f.lamps.image;
  s.lamp_absence = f.lamps.absence;
  s.lamp_first_command = std::make_shared<const std::vector<uint32_t>>(f.lamps.views.first_command);
  s.rays = f.traced;
  if (f.rays) s.tree_ranges = f.rays->ranges;
  s.runs = std::make_shared<const std::vector<DrawRun>>(f.draws.runs);
  s.features = scene_features(f.facts, f.facts.environment || f.request.neutral_light || f.facts.probes > 0);
  if (f.facts.probes > 0) s.features.push_back(probes_constant(f.facts.probes));
  if (f.surfaces.specular_aa != 0) s.features.push_back(specular_aa_constant(f.surfaces.specular_aa));
  if (f.facts.image_light) {
    const bool sampled = IblMethod(f.image_light.method) == IblMethod::sampled;
    const auto more = image_light_constants(f.image_light.method, !sampled && f.image_light.irradiance_px > 0);
    s.features.insert(s.features.end(), more.begin(), more.end());
  }
  s.item_count = u.item_count, s.light_count = u.constants.light_count;
  s.item_group_count = uint32_t(u.item_groups.size()), s.item_span_count = uint32_t(u.item_spans.size());
  s.batch_span_count = uint32_t(u.batch_spans.size()), s.transform_count = u.transform_count;
  s.light_group_count = uint32_t(u.light_groups.size());
  s.time_s = f.pose.time_s;
  s.cull_group_count = uint32_t(u.groups.size());
  s.batch_count = u.batch_count;
  for (const shared::DeformJob& job : u.deform_jobs) s.deform_vertices.push_back(job.vertex_count);
  s.deformed_words = u.deformed_words;
  s.width_px = uint32_t(f.request.width_px);
  s.height_px = uint32_t(f.request.height_px);
  s.samples = uint32_t(f.request.samples);
  s.stores_samples = f.stores_samples;
  if (f.facts.blend_items + f.facts.refracting_items > 0)
    std::tie(s.blended_near_m, s.blended_far_m) = blended_depths(f.data, f.draws, f.view);
  if (f.request.draws_volumetric()) s.volumetric_reach_m = volumetric_reach_m(*f.request.look.volumetric, f.data);
  return s;
}

std::string probe_note(const PlannedFrame& f) {
  const size_t count = f.request.look.probes.size();
  if (count == 0) return {};
  const std::string probes = fmt::format("{} reflection probe{}", count, count == 1 ? "" : "s");
  if (!f.request.draws_probes()) return probes + " of the look left out (--effects)";
  if (f.request.neutral_light) return probes + " of the look left out: under the neutral light there is no scene's own";
  if (f.facts.probes == 0) return probes + " of the look left out: no surface takes light";
  return fmt::format("{} of the look: surfaces in {} reflect an image of the scene, six views of {}x{} taken once",
                     probes, count == 1 ? "its box" : "their boxes", f.probes.size_px, f.probes.size_px);
}

void add_notes(PlannedFrame& f, const KnobValues& knobs) {
  const Supersample::Knobs& supersample = knobs.get<Supersample::Knobs>();
  if (supersample.pictures() > 1 && knobs.get<Resolve::Knobs>().samples > 1)
    f.notes.push_back(fmt::format("supersampling ({} x {} a pixel) takes the place of multisampling",
                                  supersample.grid().x, supersample.grid().y));
  if (const std::string note = probe_note(f); !note.empty()) f.notes.push_back(note);
  std::vector<std::string> missing = not_drawn(f.facts, f.pose);
  if (f.facts.sized_lights > 0 && f.facts.takes_light() && !f.traced.soft_lamps)
    missing.push_back("sizes of point and spot lights (drawn as points: shadows.method, shadows.soft)");
  if (!missing.empty()) f.notes.push_back(fmt::format("not drawn yet (candela reference does): {}", joined(missing)));
}

// Passes of which there is nothing and no reason yet are other techniques'.
void leave_out_others(GraphBuilder& builder, std::string_view technique) {
  const auto is_of = [](std::string_view name, std::string_view pass) {
    return name.substr(0, name.find('.')) == pass;
  };
  AllPasses::each([&]<class P>(std::type_identity<P>) {
    for (const GraphBuilder::Pass& pass : builder.passes())
      if (is_of(pass.name, P::name)) return;
    for (const LeftOut& pass : builder.left_out())
      if (is_of(pass.pass, P::name)) return;
    builder.leave_out(std::string(P::name), fmt::format("the technique {} does without it (--technique)", technique));
  });
}

}  // namespace

Expected<PlannedFrame> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s) {
  PlannedFrame f;
  f.clock.begin("animate");
  const auto asked = ask_frame(job, context, wanted, time_s);
  if (!asked) return std::unexpected(asked.error());
  auto surveyed = survey_frame(*asked, context, time_s);
  if (!surveyed) return std::unexpected(surveyed.error());
  const KnobValues* const knobs = &asked->knobs;
  const Technique* const technique = asked->technique;
  f.pose = std::move(surveyed->pose), f.view = std::move(surveyed->view), f.data = std::move(surveyed->data);
  f.sky = std::move(surveyed->sky), f.facts = surveyed->facts, f.request = std::move(surveyed->request);
  f.notes = std::move(surveyed->notes);
  const DevicePose& on_device = surveyed->on_device;
  f.light_instances = on_device.lights ? on_device.lights->instance_count : 0;
  f.mesh_instances = on_device.instances ? on_device.instances->instance_count : 0;
  f.stores_samples = context.stores_samples && knobs->get<SampleStoreKnobs>().in != SampleStoreKnobs::buffer;
  f.textures = knobs->get<TextureKnobs>();
  f.surfaces = knobs->get<SurfaceKnobs>();
  f.image_light = knobs->get<IblKnobs>();
  f.probes = knobs->get<ProbeKnobs>();
  const bool refraction = f.request.wants_true(Refraction::effect);
  const float floor_lux = knobs->get<LightRangeKnobs>().floor_lux;
  const uint32_t bounded = apply_light_floor(f.data.lights, floor_lux);
  if (bounded > 0)
    f.notes.push_back(fmt::format(
        "{} light{} without range end{} where {} would give less than {} lux (lights.floor_lux; 0 for none)", bounded,
        bounded == 1 ? "" : "s", bounded == 1 ? "s" : "", bounded == 1 ? "it" : "they", floor_lux));
  f.draws = make_draw_list(context.scene, f.pose, f.data, refraction);
  const AmbientSh ambient = f.sky ? f.sky.ambient() : f.request.neutral_light ? neutral_ambient() : AmbientSh{};
  f.upload = make_frame_upload(context.scene, f.pose, f.view, f.data, f.draws, context.layout, f.request, ambient);
  if (technique->keys != Technique::Keys::none) add_batches(f.draws, f.upload);
  const bool traces_keys = technique->keys == Technique::Keys::traced && f.upload.batch_count > 0;
  if (traces_keys) add_triangle_numbers(f.draws, f.upload);
  if (f.request.has_layer("motion") && !context.face) {
    const auto before = pose_before(context.scene, asked->job, time_s, f.pose);
    if (!before) return std::unexpected(before.error());
    add_motion(f.data, f.view, before->data, before->view, f.upload);
  }
  place_probes(std::span(f.request.look.probes).first(f.facts.probes), f.view, f.upload.constants.probes);

  f.clock.begin("light_grid");
  const DrawnExtent extent = drawn_extent(context.scene, f.data, f.view);
  LightKnobs lists = knobs->get<LightKnobs>();
  if (LightOrder(lists.order) == LightOrder::automatic)
    lists.order = int(context.cpu ? LightOrder::segments : LightOrder::sorted);
  f.light_grid =
      make_light_grid(technique->light_grid, f.data, f.upload.constants, extent.farthest_m, extent.reach_m, lists);
  f.upload.constants.grid = f.light_grid.constants;
  if (!f.light_grid.note.empty()) f.notes.push_back(f.light_grid.note);

  f.clock.begin("sun_shadows");
  const bool culling = knobs->get<Cull::Knobs>().enabled != 0;
  f.shadow_colors = draws_shadow_colors(f.facts, f.request, *knobs);
  const Supersample::Knobs& supersample = knobs->get<Supersample::Knobs>();
  const int longer_side = std::max(f.request.width_px, f.request.height_px);
  auto suns = plan_suns(context.scene, f.data, f.view, f.draws, f.facts, f.request, knobs->get<SunKnobs>(), longer_side,
                        culling, f.shadow_colors, f.upload);
  if (!suns) return std::unexpected(suns.error());
  f.suns = std::move(*suns);

  if (f.request.draws_fog()) {
    f.clock.begin("fog");
    const FogKnobs& fog = knobs->get<FogKnobs>();
    f.upload.constants.fog =
        frame_fog(f.request.look, f.view, f.data, extent.farthest_m,
                  fog.nodes(uint32_t(f.request.width_px), uint32_t(f.request.height_px)), uint32_t(fog.sky_directions));
  }

  f.clock.begin("lamp_shadows");
  auto lamps =
      plan_lamps(context.scene, f.data, f.view, f.draws, f.facts, f.request, knobs->get<LampKnobs>(),
                 f.request.height_px * int(supersample.grid().y), longer_side, culling, f.shadow_colors, f.upload);
  if (!lamps) return std::unexpected(lamps.error());
  f.lamps = std::move(*lamps);
  for (const auto* notes : {&f.suns.notes, &f.lamps.notes}) f.notes.insert(f.notes.end(), notes->begin(), notes->end());

  f.clock.begin("trees");
  plan_rays(f, context, *knobs, traces_keys);

  f.clock.begin("plan");
  const auto parsed_background = parse_background(job.background);
  if (!parsed_background) return std::unexpected(parsed_background.error());
  const std::array<float, 4> background = exposed(*parsed_background, f.upload.constants.pre_exposure);
  f.upload.constants.background = {background[0], background[1], background[2], background[3]};
  std::vector<DumpRequest> requests = wanted.dumps;
  if (const auto image = image_of_view(job.view); image && wanted.display) requests.push_back(*image);
  std::map<Hash128, KeptState> kept_states;
  const auto build = [&](GraphBuilder& builder) {
    f.imports.clear();
    SceneInputs inputs = import_scene(builder, context, f);
    inputs.background = background;
    Frame frame{builder, f.facts, f.request, *knobs, {}, {}};
    frame.kept_states = kept_states;
    if (!f.dumps.empty())
      frame.observe = [&](Frame& observed, const std::string& pass) { add_dumps(observed, pass, f.dumps); };
    build_frame(frame, inputs, *technique);
    if (requests.empty())
      builder.leave_out(std::string(Dump::name), "no image is asked for (render --dump, --view debug.PASS.IMAGE)");
    leave_out_others(builder, technique->name);
    f.outputs = std::move(frame.outputs);
    f.counts = frame.counts;
    f.reports = std::move(frame.reports);
    f.kept = std::move(frame.kept);
    f.graph = compile_graph(builder);
  };
  auto builder = std::make_unique<GraphBuilder>();
  build(*builder);
  f.hash = plan_hash(f.graph.plan);
  for (const KeptUse& use : f.kept)
    if (const KeptState state = context.kept(use.key, use.desc); state != KeptState::unknown)
      kept_states[use.key] = state;
  if (!kept_states.empty()) build(*(builder = std::make_unique<GraphBuilder>()));
  if (!requests.empty()) {
    auto dumps = place_dumps(requests, *builder, f.graph.plan);
    if (!dumps) return std::unexpected(dumps.error());
    f.dumps = std::move(*dumps);
    build(*(builder = std::make_unique<GraphBuilder>()));
  }
  add_notes(f, *knobs);
  f.clock.end();
  return f;
}

Expected<PlannedFrame> plan_frame(const Job& job, const Scene& scene, const WantedOutputs& wanted, double time_s) {
  const auto layout = layout_geometry(scene);
  if (!layout) return std::unexpected(layout.error());
  const auto look = look_of(job, time_s);
  if (!look) return std::unexpected(look.error());
  const auto sky = JobSky::read_logged(job, *look, scene);
  if (!sky) return std::unexpected(sky.error());
  return plan_frame(job, PlanContext{scene, *layout, &*sky}, wanted, time_s);
}

}  // namespace candela
