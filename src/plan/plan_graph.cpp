#include "plan/plan_graph.h"

#include <bit>
#include <cmath>

#include "base/room.h"
#include "passes/debug/dump.h"
#include "passes/shared/features.h"
#include "passes/shared/pass_list.h"
#include "passes/surfaces/ibl_knobs.h"
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

// What of the materials and of how they are lit shaders are made for.
std::vector<SpecConstant> features_of(const FrameShape& shape) {
  const SceneFacts& facts = shape.facts;
  const IblKnobs& image_light = shape.knobs.get<IblKnobs>();
  const ReliefKnobs& relief = shape.knobs.get<ReliefKnobs>();
  std::vector<SpecConstant> features =
      scene_features(facts, facts.environment || shape.request.neutral_light || facts.probes > 0);
  if (facts.probes > 0) features.push_back(probes_constant(facts.probes));
  if (facts.any_relief)
    features.push_back(relief_constant(relief.steps, relief.refinements, relief.light_steps, relief.by_sample != 0));
  if (const float aa = shape.knobs.get<SurfaceKnobs>().specular_aa; aa != 0)
    features.push_back(specular_aa_constant(aa));
  if (facts.image_light) {
    const bool sampled = IblMethod(image_light.method) == IblMethod::sampled;
    const bool mirrors = facts.any_smooth && IblMethod(image_light.method) == IblMethod::lobe;
    const auto more = image_light_constants(image_light.method, !sampled && image_light.irradiance_px > 0,
                                            mirrors ? image_light.mirror_taps : 0);
    features.insert(features.end(), more.begin(), more.end());
  }
  return features;
}

// Points to what is not the pointer's to delete.
template <class T>
std::shared_ptr<const T> lent(const T& value) {
  return {std::shared_ptr<const void>(), &value};
}

// What passes take of a frame of the shape: every buffer that it has content for is imported, and what is only recorded
// with lies in the graph.
SceneInputs import_scene(GraphBuilder& builder, const PlannedFrame& f, PlannedGraph& made) {
  const FrameShape& shape = made.shape;
  SceneInputs s = shape.scene;
  made.imports.clear();
  for (const FrameShape::Row& row : shape.rows) {
    made.imports.push_back(-1);
    if (row.size_bytes == 0) continue;
    s.*row.input = builder.import_buffer(BufferDesc{std::string(row.name), row.size_bytes},
                                         row.to_fill ? GraphBuilder::Import::to_fill : GraphBuilder::Import::filled);
    made.imports.back() = (s.*row.input).resource;
  }
  if (!shape.suns.name.empty()) s.sun_image = lent(made.sun_image);
  if (!shape.lamps.name.empty()) s.lamp_image = lent(made.lamp_image);
  s.sun_key = f.sun_key, s.lamp_key = f.lamp_key;
  s.view_first_command = lent(made.sun_first_command), s.lamp_first_command = lent(made.lamp_first_command);
  s.draw_batches = lent(shape.batches);
  s.features = features_of(shape);
  s.values = &made.values;
  return s;
}

// What the frame is recorded with.
void take_values(const PlannedFrame& f, PlannedGraph& made) {
  if (f.suns.image) made.sun_image = *f.suns.image;
  if (f.lamps.image) {
    make_room(made.lamp_image.views, f.lamps.image->views.size());
    make_room(made.lamp_image.drawn, f.lamps.image->drawn.size());
    made.lamp_image = *f.lamps.image;
  }
  make_room(made.lamp_first_command, f.lamps.views.first_command.size());
  made.sun_first_command = f.suns.views.first_command, made.lamp_first_command = f.lamps.views.first_command;
  const FrameRequest& request = f.request;
  FrameValues& v = made.values;
  v.time_s = f.pose.time_s;
  v.noise_seed = request.noise_seed;
  v.subframe = request.part.index;
  v.offset_px = request.part.offset_px;
  v.motion_share = float(request.motion_share);
  v.exposure = std::exp2(request.exposure_ev - request.pre_exposure_ev);
  v.radiance_scale = std::exp2(-request.pre_exposure_ev);
  v.stored_scale = float(1.0 / double(std::exp2(request.pre_exposure_ev)));
  const Look& look = request.look;
  v.agx_min_ev = float(look.tone_mapping.agx_min_ev), v.agx_max_ev = float(look.tone_mapping.agx_max_ev);
  if (f.facts.blend_items + f.facts.refracting_items > 0)
    std::tie(v.blended_near_m, v.blended_far_m) = blended_depths(f.data, f.draws, f.view);
  if (request.draws_volumetric()) v.volumetric_reach_m = volumetric_reach_m(*look.volumetric, f.data);
  v.light_count = f.upload.constants.light_count;
  v.metaball_blocks = uint32_t(f.upload.metaball_blocks.size());
  if (look.bloom) v.bloom = *look.bloom;
  if (look.exposure.automatic) v.auto_exposure = *look.exposure.automatic;
  if (look.occlusion) v.occlusion = *look.occlusion;
  if (look.volumetric) v.volumetric = *look.volumetric;
  for (auto& [resource, key] : made.graph.keys) {
    const bool is_sun = made.graph.plan.resources[size_t(resource)].name() == made.sun_image.name;
    key = is_sun ? *f.sun_key : *f.lamp_key;
  }
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

std::vector<DumpRequest> dump_requests(const Job& job, const WantedOutputs& wanted) {
  std::vector<DumpRequest> requests = wanted.dumps;
  if (const auto image = image_of_view(job.view); image && wanted.display) requests.push_back(*image);
  return requests;
}

// Filled once; frames with dumps are filled a second time, for only a plan knows which images are made.
Expected<std::shared_ptr<PlannedGraph>> make_graph(const PlanContext& context, std::vector<DumpRequest> requests,
                                                   const FrameShape& shape, const PlannedFrame& f) {
  auto made = std::make_shared<PlannedGraph>();
  made->shape = shape;
  take_values(f, *made);
  const auto fill = [&](GraphBuilder& builder) {
    if (shape.parts) builder.restrict_picture(*shape.parts);
    const SceneInputs inputs = import_scene(builder, f, *made);
    Frame frame{builder, shape.facts, shape.request, shape.knobs, {}, {}, {}, -1, made->values};
    if (!made->dumps.empty())
      frame.observe = [&](Frame& observed, const std::string& pass) { add_dumps(observed, pass, made->dumps); };
    build_frame(frame, inputs, *shape.technique);
    if (requests.empty())
      builder.leave_out(std::string(Dump::name), "no image is asked for (render --dump, --view debug.PASS.IMAGE)");
    leave_out_others(builder, shape.request.part.role, shape.technique->name);
    made->outputs = std::move(frame.outputs);
    made->counts = frame.counts;
    made->reports = std::move(frame.reports);
  };
  KeptKeys kept = context.kept ? *context.kept : KeptKeys{};
  kept.pool = shape.pool;
  GraphBuilder builder;
  fill(builder);
  made->graph = compile_graph(builder);
  made->hash = made->graph.hash;
  const auto is_kept = [&](const GraphBuilder::Resource& r) {
    return r.key && (kept.filled.contains(*r.key) || kept.seen.contains(*r.key));
  };
  if (kept.pool || std::ranges::any_of(builder.resources(), is_kept)) made->graph = compile_graph(builder, kept);
  if (requests.empty()) return made;
  if (requests.front().name == every_image) requests = requests_of_steps(made->graph.plan);
  auto dumps = place_dumps(requests, builder, made->graph.plan);
  if (!dumps) return std::unexpected(dumps.error());
  made->dumps = std::move(*dumps);
  GraphBuilder with_dumps;
  fill(with_dumps);
  made->graph = compile_graph(with_dumps, kept);
  return made;
}

// Of the images of shadow maps that outlive frames: what is kept is the depth of what casts, in an image of that form.
void find_keys(const PlanContext& context, PlannedFrame& f) {
  f.sun_key.reset(), f.lamp_key.reset();
  const bool lamps = f.lamps.image && !f.lamps.image->apart;
  if (!context.kept || !(f.suns.image || lamps)) return;
  const auto casters = caster_hash(f.draws, f.upload, f.pose, f.textures, f.relief);
  if (!casters) return;
  const auto key = [&](const ViewImage& image, bool floats) {
    const Hash128 views = depth_views_key(*casters, image);
    return hash128(std::as_bytes(std::span(&views, 1)), (floats ? 1 : 0) + (f.request.open_sides ? 2 : 0));
  };
  if (f.suns.image) f.sun_key = key(*f.suns.image, false);
  if (lamps) f.lamp_key = key(*f.lamps.image, f.upload.batch_count > 0 && !f.shadow_colors);
}

}  // namespace

std::shared_ptr<PlannedGraph> KeptGraphs::find(const FrameShape& shape) {
  const auto found = std::ranges::find_if(graphs_, [&](const auto& graph) { return graph->shape == shape; });
  if (found == graphs_.end()) return nullptr;
  std::rotate(graphs_.begin(), found, found + 1);
  return graphs_.front();
}

void KeptGraphs::add(std::shared_ptr<PlannedGraph> graph) {
  ++made_;
  if (graphs_.size() == most) graphs_.pop_back();
  graphs_.insert(graphs_.begin(), std::move(graph));
}

bool asks_dumps(const Job& job, const WantedOutputs& wanted) {
  // The view's name is only looked at where it may be an image's.
  return !wanted.dumps.empty() ||
         (wanted.display && job.view.find('.') != std::string::npos && image_of_view(job.view));
}

Expected<void> plan_graph(const AskedFrame& asked, const PlanContext& context, const WantedOutputs& wanted,
                          const std::optional<PictureParts>& parts, PlannedFrame& f) {
  find_keys(context, f);
  upload_table(f, context.layout, f.rows);
  std::optional<FrameShape> own;
  FrameShape& shape = context.graphs ? context.graphs->shape() : own.emplace();
  take_shape(asked, f, context, f.rows, parts, shape);
  const bool dumps = asks_dumps(asked.job, wanted);
  f.made = context.graphs && !dumps ? context.graphs->find(shape) : nullptr;
  if (f.made) {
    take_values(f, *f.made);
    return {};
  }
  auto made = make_graph(context, dump_requests(asked.job, wanted), shape, f);
  if (!made) return std::unexpected(made.error());
  f.made = std::move(*made);
  if (context.graphs && !dumps) context.graphs->add(f.made);
  return {};
}

}  // namespace candela
