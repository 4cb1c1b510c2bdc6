#include "plan/light_frame.h"

#include <cmath>
#include <numbers>

#include "passes/geometry/cull.h"
#include "passes/post/supersample.h"
#include "passes/shadows/lamp_knobs.h"
#include "passes/shadows/sun_knobs.h"
#include "passes/shared/knob_values.h"
#include "passes/shared/light_knobs.h"
#include "passes/volumes/fog_knobs.h"
#include "plan/frame_fog.h"
#include "scene/largest_score.h"
#include "scene/moving_nodes.h"

namespace candela {
namespace {

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

}  // namespace

Expected<std::vector<uint8_t>> moving_of(const Scene& scene, const std::string& animation) {
  const auto animations = choose_animations(scene, animation);
  if (!animations) return std::unexpected(animations.error());
  const std::vector<bool> moving = moving_nodes(scene, *animations);
  return std::vector<uint8_t>(moving.begin(), moving.end());
}

Expected<void> light_frame(const AskedFrame& asked, const SurveyedFrame& frame, const PackedFrame& packed,
                           const PlanContext& context, StageClock& clock, LitFrame& lit) {
  lit.notes.clear();
  const KnobValues& knobs = asked.knobs;
  const FrameRequest& request = frame.request;

  clock.begin("light_grid");
  const DrawnExtent extent = drawn_extent(context.scene, frame.data, frame.view);
  LightKnobs lists = knobs.get<LightKnobs>();
  if (LightOrder(lists.order) == LightOrder::automatic)
    lists.order = int(context.cpu ? LightOrder::segments : LightOrder::sorted);
  make_light_grid(asked.technique->light_grid, frame.data, packed.upload.constants, extent.farthest_m, extent.reach_m,
                  lists, lit.light_grid);
  if (!lit.light_grid.note.empty()) lit.notes.push_back(lit.light_grid.note);

  clock.begin("sun_shadows");
  std::vector<uint8_t> moving;
  if (context.moving.empty()) {
    auto found = moving_of(context.scene, asked.job.animation);
    if (!found) return std::unexpected(found.error());
    moving = std::move(*found);
  }
  lit.shadow_colors = draws_shadow_colors(frame.facts, request, knobs);
  const MapOptions maps{.longer_side_px = std::max(request.width_px, request.height_px),
                        .scene_size_m = context.layout.size_m,
                        .culling = knobs.get<Cull::Knobs>().enabled != 0,
                        .see_through = lit.shadow_colors,
                        .floats = packed.upload.batch_count > 0,
                        .kept_lamps = context.kept_lamps,
                        .moving = context.moving.empty() ? std::span<const uint8_t>(moving) : context.moving,
                        .textures = knobs.get<TextureKnobs>(),
                        .relief = knobs.get<ReliefKnobs>()};
  if (auto fine = plan_suns(context.scene, frame, packed, knobs.get<SunKnobs>(), maps, lit.suns); !fine) return fine;

  lit.fog.reset();
  if (request.draws_fog()) {
    clock.begin("fog");
    const FogKnobs& fog = knobs.get<FogKnobs>();
    const glm::uvec3 nodes = fog.nodes(uint32_t(request.width_px), uint32_t(request.height_px));
    lit.fog = frame_fog(request.look, frame.view, frame.data, extent.farthest_m, nodes, uint32_t(fog.sky_directions));
  }

  clock.begin("local_shadows");
  const int rows = request.height_px * int(knobs.get<Supersample::Knobs>().grid().y);
  if (auto fine = plan_lamps(context.scene, frame, packed, knobs.get<LampKnobs>(), rows, maps, lit.lamps); !fine)
    return fine;
  for (const auto* notes : {&lit.suns.notes, &lit.lamps.notes}) lit.notes.append(*notes);
  return {};
}

}  // namespace candela
