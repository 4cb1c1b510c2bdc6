#include "plan/plan_frame.h"

#include <bit>
#include <cstring>

#include "base/text.h"
#include "job/not_drawn.h"
#include "passes/debug/dump.h"
#include "passes/post/resolve.h"
#include "passes/post/supersample.h"
#include "passes/shared/features.h"
#include "passes/shared/knob_values.h"
#include "passes/shared/pass_list.h"
#include "passes/surfaces/sample_store.h"
#include "plan/caster_hash.h"
#include "plan/frame_fog.h"
#include "plan/step_dumps.h"
#include "plan/upload_table.h"

namespace candela {
namespace {

// Between which depths along the view axis surfaces lie that are seen through, as far as they are before the camera.
std::pair<float, float> blended_depths(const FrameData& data, const DrawList& draws, const View& view) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = view.near_m;
  const glm::dvec3 forward = -glm::dvec3(glm::transpose(view.view_from_relative)[2]);
  const uint32_t grouped = draws.item_count() - uint32_t(draws.order.size());  // all of them come before
  for (const DrawBatch& run : draws.batches) {
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
  if (context.kept && (s.sun_image || (f.lamps.image && !f.lamps.image->apart)))
    if (const auto casters = caster_hash(f.draws, u, f.pose, f.textures, f.relief)) {
      if (s.sun_image) s.sun_key = depth_views_key(*casters, *s.sun_image);
      if (f.lamps.image && !f.lamps.image->apart) s.lamp_key = depth_views_key(*casters, *f.lamps.image);
    }
  s.view_first_command = std::make_shared<const std::vector<uint32_t>>(f.suns.views.first_command);
  s.lamp_image = f.lamps.image;
  s.lamp_absence = f.lamps.absence;
  s.lamp_first_command = std::make_shared<const std::vector<uint32_t>>(f.lamps.views.first_command);
  s.rays = f.traced;
  if (f.rays) s.tree_ranges = f.rays->ranges;
  s.draw_batches = std::make_shared<const std::vector<DrawBatch>>(f.draws.batches);
  s.features = scene_features(f.facts, f.facts.environment || f.request.neutral_light || f.facts.probes > 0);
  if (f.facts.probes > 0) s.features.push_back(probes_constant(f.facts.probes));
  if (f.facts.any_relief) s.features.push_back(relief_constant(f.relief.steps, f.relief.refinements));
  if (f.surfaces.specular_aa != 0) s.features.push_back(specular_aa_constant(f.surfaces.specular_aa));
  if (f.facts.image_light) {
    const bool sampled = IblMethod(f.image_light.method) == IblMethod::sampled;
    const bool mirrors = f.facts.any_smooth && IblMethod(f.image_light.method) == IblMethod::lobe;
    const auto more = image_light_constants(f.image_light.method, !sampled && f.image_light.irradiance_px > 0,
                                            mirrors ? f.image_light.mirror_taps : 0);
    s.features.insert(s.features.end(), more.begin(), more.end());
  }
  s.item_count = u.item_count, s.light_count = u.constants.light_count;
  s.item_group_count = uint32_t(u.item_groups.size()), s.item_span_count = uint32_t(u.item_spans.size());
  s.batch_span_count = uint32_t(u.batch_spans.size()), s.transform_count = u.transform_count;
  s.light_group_count = uint32_t(u.light_groups.size());
  s.metaball_body_count = uint32_t(u.metaball_bodies.size());
  s.metaball_block_count = uint32_t(u.metaball_blocks.size());
  s.metaball_block_room = std::bit_ceil(std::max(s.metaball_block_count, 1u));
  s.time_s = f.pose.time_s;
  const glm::vec4& background = u.constants.background;
  s.background = {background.x, background.y, background.z, background.w};
  s.cull_group_count = uint32_t(u.groups.size());
  s.batch_count = u.batch_count;
  for (const shared::DeformJob& job : u.deform_jobs) s.deform_vertices.push_back(job.vertex_count);
  s.deformed_words = u.deformed_words;
  s.open_sides = f.request.open_sides;
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

// Those of the stages in their order, and what only the whole frame tells.
void add_notes(PlannedFrame& f, const KnobValues& knobs) {
  for (auto* notes : {&f.SurveyedFrame::notes, &f.LitFrame::notes, &f.TracedFrame::notes})
    f.notes.insert(f.notes.end(), notes->begin(), notes->end());
  const Supersample::Knobs& supersample = knobs.get<Supersample::Knobs>();
  if (supersample.pictures() > 1 && knobs.get<Resolve::Knobs>().samples > 1)
    f.notes.push_back(fmt::format("supersampling ({} x {} a pixel) takes the place of multisampling",
                                  supersample.grid().x, supersample.grid().y));
  if (supersample.pictures() >= 16 && f.rays)
    f.notes.push_back(
        "rays from every sample of every pixel, as at quality exact: candela reference --mode direct is the truth "
        "itself, and on a CPU device the quicker of the two");
  if (const std::string note = probe_note(f); !note.empty()) f.notes.push_back(note);
  std::vector<std::string> missing = not_drawn(f.facts, f.pose);
  if (f.facts.sized_lights > 0 && f.facts.takes_light() && !f.traced.soft_lamps)
    missing.push_back("sizes of point and spot lights (drawn as points: local.method, local.soft)");
  if (!missing.empty()) f.notes.push_back(fmt::format("not drawn yet (candela reference does): {}", joined(missing)));
}

// Passes of which there is nothing and no reason yet are other techniques'.
void leave_out_others(GraphBuilder& builder, SubframePart::Role role, std::string_view technique) {
  std::string reason = fmt::format("the technique {} does without it (--technique)", technique);
  if (role == SubframePart::Role::mean) reason = "the picture's subframes have it";
  if (role == SubframePart::Role::subframe) reason = "it follows once for all subframes of the picture";
  const auto is_of = [](std::string_view name, std::string_view pass) {
    return name.substr(0, name.find('.')) == pass;
  };
  for (const PassInfo& info : pass_list()) {
    const bool is_declared =
        std::ranges::any_of(builder.passes(), [&](const auto& pass) { return is_of(pass.name, info.name); });
    const bool has_reason =
        std::ranges::any_of(builder.left_out(), [&](const LeftOut& pass) { return is_of(pass.pass, info.name); });
    if (!is_declared && !has_reason) builder.leave_out(std::string(info.name), reason);
  }
}

// What later stages decided of what the first packed: whose light has which shadow, the lists' grid, fog, and where
// what is drawn stands for rays.
void complete_upload(const SurveyedFrame& frame, const LitFrame& lit, const TracedFrame& traced, double least_light_m,
                     PackedFrame& packed) {
  FrameUpload& upload = packed.upload;
  upload.constants.grid = lit.light_grid.constants;
  if (lit.fog) upload.constants.fog = *lit.fog;
  upload.constants.least_light_distance2 = float(least_light_m * least_light_m);
  upload.constants.trace_shift = glm::vec3(traced.shift);
  upload.constants.trace_shift_rest = glm::vec3(traced.shift - glm::dvec3(upload.constants.trace_shift));
  for (size_t i = 0; i < lit.suns.lights.size(); ++i) upload.lights[lit.suns.lights[i]].shadow = uint32_t(i + 1);
  for (size_t i = 0; i < lit.lamps.lights.size(); ++i)
    upload.lights[lit.lamps.lights[i]].shadow = shared::lamp_shadow_bit | uint32_t(i + 1);
  if (traced.rays && traced.traced.surfaces) add_drawn_items(packed.draws, upload);
  // Groups stand behind the lights (shaders/terms.frag).
  if (const std::vector<uint32_t>& groups = frame.light_group_of; !groups.empty()) {
    upload.lights.resize(groups.size() + (groups.size() * sizeof(uint32_t) - 1) / sizeof(shared::Light) + 1);
    std::memcpy(upload.lights.data() + groups.size(), groups.data(), groups.size() * sizeof(uint32_t));
  }
}

// The camera's culling planes are those of the part alone, and a margin for the samples of its pixels.
void cull_beyond(const PixelRect& part, const View& view, const FrameRequest& request, FrameUpload& upload) {
  constexpr int margin_px = 2;
  const PixelRect r = grown(part, margin_px, 1, request.width_px, request.height_px);
  const glm::dvec2 size(request.width_px, request.height_px);
  const glm::dvec2 low = 2.0 * glm::dvec2(r.x, r.y) / size - 1.0,
                   high = 2.0 * glm::dvec2(r.end_x(), r.end_y()) / size - 1.0;
  const glm::dvec2 middle = 0.5 * (low + high), half = 0.5 * (high - low);
  glm::dmat4 part_from_clip(1.0);
  for (int axis = 0; axis < 2; ++axis) {
    part_from_clip[axis][axis] = 1 / half[axis];
    part_from_clip[3][axis] = -middle[axis] / half[axis];
  }
  const FrustumPlanes planes = frustum_planes(part_from_clip * view.clip_from_relative);
  for (size_t p = 0; p < 5; ++p) upload.constants.planes[p] = glm::vec4(planes[p]);
}

std::vector<DumpRequest> dump_requests(const Job& job, const WantedOutputs& wanted) {
  std::vector<DumpRequest> requests = wanted.dumps;
  if (const auto image = image_of_view(job.view); image && wanted.display) requests.push_back(*image);
  return requests;
}

// The graph of the frame, which is filled once; frames with dumps are filled a second time, for only a plan knows which
// images are made.
Expected<void> plan_graph(const AskedFrame& asked, const PlanContext& context, const WantedOutputs& wanted,
                          const std::optional<PictureParts>& parts, PlannedFrame& f) {
  std::vector<DumpRequest> requests = dump_requests(asked.job, wanted);
  const auto fill = [&](GraphBuilder& builder) {
    f.imports.clear();
    if (parts) builder.restrict_picture(*parts);
    const SceneInputs inputs = import_scene(builder, context, f);
    Frame frame{builder, f.facts, f.request, asked.knobs, {}, {}};
    if (!f.dumps.empty())
      frame.observe = [&](Frame& observed, const std::string& pass) { add_dumps(observed, pass, f.dumps); };
    build_frame(frame, inputs, *asked.technique);
    if (requests.empty())
      builder.leave_out(std::string(Dump::name), "no image is asked for (render --dump, --view debug.PASS.IMAGE)");
    leave_out_others(builder, f.request.part.role, asked.technique->name);
    f.outputs = std::move(frame.outputs);
    f.counts = frame.counts;
    f.reports = std::move(frame.reports);
  };
  KeptKeys kept = context.kept ? *context.kept : KeptKeys{};
  if (f.lamps.pool) kept.pool = {f.lamps.pool->layer_px, f.lamps.pool->layers, !f.lamps.pool->fresh};
  GraphBuilder builder;
  fill(builder);
  f.graph = compile_graph(builder);
  f.hash = plan_hash(f.graph.plan);
  const auto is_kept = [&](const GraphBuilder::Resource& r) {
    return r.key && (kept.filled.contains(*r.key) || kept.seen.contains(*r.key));
  };
  if (kept.pool || std::ranges::any_of(builder.resources(), is_kept)) f.graph = compile_graph(builder, kept);
  if (requests.empty()) return {};
  if (requests.front().name == every_image) requests = requests_of_steps(f.graph.plan);
  auto dumps = place_dumps(requests, builder, f.graph.plan);
  if (!dumps) return std::unexpected(dumps.error());
  f.dumps = std::move(*dumps);
  GraphBuilder with_dumps;
  fill(with_dumps);
  f.graph = compile_graph(with_dumps, kept);
  return {};
}

}  // namespace

namespace {

Expected<PlannedFrame> plan_one(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                double time_s) {
  StageClock clock;
  clock.begin("animate");
  const auto asked = ask_frame(job, context, wanted, time_s);
  if (!asked) return std::unexpected(asked.error());
  auto frame = survey_frame(*asked, context, time_s);
  if (!frame) return std::unexpected(frame.error());
  auto packed = pack_frame(*asked, *frame, context, time_s);
  if (!packed) return std::unexpected(packed.error());
  // What is looked at is the frame's own.
  PlanContext lighting = context;
  if (!dump_requests(asked->job, wanted).empty()) lighting.kept_lamps = nullptr;
  auto lit = light_frame(*asked, *frame, *packed, lighting, clock);
  if (!lit) return std::unexpected(lit.error());
  clock.begin("trees");
  TracedFrame traced = trace_frame(*asked, *frame, *packed, *lit, context);

  clock.begin("plan");
  complete_upload(*frame, *lit, traced, context.layout.least_light_distance_m, *packed);
  const auto parts = picture_parts(frame->facts, frame->request, asked->knobs, frame->notes);
  if (parts) cull_beyond(parts->seen, frame->view, frame->request, packed->upload);
  PlannedFrame f{std::move(*frame), std::move(*packed), std::move(*lit), std::move(traced)};
  f.textures = asked->knobs.get<TextureKnobs>();
  f.relief = asked->knobs.get<ReliefKnobs>();
  f.surfaces = asked->knobs.get<SurfaceKnobs>();
  f.image_light = asked->knobs.get<IblKnobs>();
  f.probes = asked->knobs.get<ProbeKnobs>();
  f.stores_samples = context.stores_samples && asked->knobs.get<SampleStoreKnobs>().in != SampleStoreKnobs::buffer;
  if (auto fine = plan_graph(*asked, context, wanted, parts, f); !fine) return std::unexpected(fine.error());
  add_notes(f, asked->knobs);
  clock.end();
  f.clock = std::move(clock);
  return f;
}

}  // namespace

Expected<PlannedFrame> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s) {
  if (context.subframe) return plan_one(job, context, wanted, time_s);
  const auto frames = subframes_of(job, context, time_s);
  if (!frames) return std::unexpected(frames.error());
  if (frames->empty()) return plan_one(job, context, wanted, time_s);
  PlanContext first = context;
  first.subframe = &frames->front();
  auto planned = plan_one(job, first, wanted, first.subframe->time_s);
  if (planned)
    planned->notes.push_back(
        fmt::format("the picture is the mean of {} such frames, from {:.6g} to {:.6g} s "
                    "(subframes.n, --shutter, --fstop)",
                    frames->front().count, frames->front().time_s, (*frames)[frames->size() - 2].time_s));
  return planned;
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
