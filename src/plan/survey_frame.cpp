#include "plan/survey_frame.h"

#include "base/allocations.h"
#include "base/log.h"
#include "base/names.h"
#include "job/light_groups.h"
#include "passes/geometry/metaballs.h"
#include "passes/occlusion/occlusion.h"
#include "passes/shadows/sun_knobs.h"
#include "passes/shared/light_knobs.h"
#include "passes/surfaces/refraction.h"
#include "passes/surfaces/terms.h"
#include "passes/surfaces/transparent.h"
#include "passes/transparency/fragments.h"
#include "passes/transparency/phenomenological.h"
#include "passes/volumes/fog_layers.h"
#include "plan/device_pose.h"
#include "plan/light_end.h"
#include "plan/posed_scene.h"
#include "scene/neutral_light.h"
#include "scene/scene_path.h"

namespace candela {
namespace {

// Layers that divide beauty composite blended surfaces by `sorted` or `layers`: by another method their sum would be
// another picture.
Expected<void> check_divided(SurveyedFrame& f) {
  const bool glass = f.facts.refracting_items > 0 && f.request.transparency == Phenomenological::method;
  if ((f.facts.blend_items == 0 && !glass) || f.request.transparency == Transparent::method ||
      f.request.transparency == Fragments::method)
    return {};
  std::vector<LayerName> parts(std::begin(Terms::layers), std::end(Terms::layers));
  parts.insert(parts.end(), std::begin(FogLayers::layers), std::end(FogLayers::layers));
  if (f.request.has_layer(all_layers)) {
    std::erase_if(f.request.layers, [&](const std::string& layer) {
      return std::ranges::find(parts, layer, &LayerName::name) != parts.end();
    });
    f.notes.push_back(
        fmt::format("layers that divide beauty are left out: they are of see-through surfaces that are drawn by the "
                    "method {} (--transparency)",
                    Transparent::method));
  }
  if (!f.request.light_groups.empty())
    return fail(ErrorKind::usage, "--light-groups",
                "are parts of beauty, which --transparency {} does not divide; take --transparency layers or sorted",
                f.request.transparency);
  for (const LayerName& part : parts)
    if (f.request.has_layer(part.name))
      return fail(ErrorKind::usage, "--layers",
                  "{} is a part of beauty, which --transparency {} does not divide; leave it out, or take "
                  "--transparency layers or sorted",
                  part.name, f.request.transparency);
  return {};
}

// The frame of a subframe is larger than the picture, and what is wanted of it lies elsewhere.
void widen(const ImageWindow& window, FrameRequest& request) {
  request.part.first_px = window.first_px, request.part.offset_px = window.offset_px;
  if (window.margin_px == glm::ivec2(0)) return;
  PixelRect wanted = request.region.value_or(PixelRect{0, 0, request.width_px, request.height_px});
  wanted.x += window.first_px.x, wanted.y += window.first_px.y;
  request.region = wanted;
  request.width_px += 2 * window.margin_px.x, request.height_px += 2 * window.margin_px.y;
}

// Gives lights without a range one, as the knobs say.
void end_lights(const LightRangeKnobs& knobs, const Scene& scene, SurveyedFrame& f) {
  LightEnd end{std::max(knobs.floor_lux, 0.0f)};
  const bool by_loss = knobs.floor_lux < 0;
  // What lights ended at before their loss was known (docs/building/decisions.md).
  constexpr double usual_lux = 0.01;
  if (by_loss) end = choose_light_end(scene, f.data, double(knobs.lost), double(f.request.exposure_ev), usual_lux);
  const size_t lamps = f.data.lights.size();
  const size_t bounded = apply_light_end(f.data.lights, end), stand_ins = f.data.lights.size() - lamps;
  if (bounded == 0) return;
  std::string said =
      fmt::format("{} light{} without range end{} where {} would give less than {:.3g} lux", bounded,
                  bounded == 1 ? "" : "s", bounded == 1 ? "s" : "", bounded == 1 ? "it" : "they", end.floor_lux);
  if (!by_loss) {
    f.notes.push_back(said + " (lights.floor_lux; 0 for none)");
    return;
  }
  if (stand_ins > 0)
    said += fmt::format(", with {} stand-in{} for what lies beyond", stand_ins, stand_ins == 1 ? "" : "s");
  const char* does = stand_ins > 0 ? "are off by" : "lose";
  if (!end.held)
    f.notes.push_back(
        fmt::format("{}: surfaces {} at most {:.2g} % of their light (lights.lost)", said, does, 100 * end.lost));
  else
    f.notes.push_back(
        fmt::format("{}: surfaces {} up to {:.2g} % of their light, more than lights.lost allows, for "
                    "lists would grow too long (lights.floor_lux=0 for none)",
                    said, does, 100 * end.lost));
}

}  // namespace

Expected<void> survey_frame(const AskedFrame& asked, const PlanContext& context, double time_s, SurveyedFrame& f) {
  const Job& job = asked.job;
  f.request = asked.request;
  f.notes = asked.notes;
  f.on_device = posed_on_device(f.request, asked.knobs, *asked.technique, context.on_device, context.cpu);
  PosedScene posed{std::move(f.pose), {}, std::move(f.data), {}, std::move(f.pose_state)};
  f.pose_state.parts = 0;  // of no pose after an error
  if (auto fine = pose_scene(context.scene, job, context.parts, time_s, f.request.look.lights.radius_m, context.face,
                             f.on_device, double(asked.knobs.get<MetaballKnobs>().cell), context.subframe, posed);
      !fine)
    return std::unexpected(fine.error());
  f.pose = std::move(posed.pose), f.view = std::move(posed.view), f.data = std::move(posed.data);
  f.pose_state = std::move(posed.state);
  if (f.request.part.role == SubframePart::Role::subframe) widen(posed.window, f.request);
  if (const auto& paths = context.scene.paths) f.notes.insert(f.notes.end(), paths->notes.begin(), paths->notes.end());
  f.light_group_of.clear();
  f.sky = {};
  if (!f.request.light_groups.empty()) {
    auto groups = light_group_of(job, context.scene, f.data.lights);
    if (!groups) return std::unexpected(groups.error());
    f.light_group_of = std::move(*groups);
  }
  if (std::string note = clip_note(context.scene, job.animation); !note.empty()) f.notes.push_back(std::move(note));
  if (context.sky) f.sky = context.sky->at(f.request.look, f.data, f.notes);
  f.sky.shows_suns = !context.face;
  add_sky_suns(f.sky, f.data);
  f.request.look.sky.rotation_deg = f.sky.rotation_deg;  // a sky of air turns with its sun
  const bool refraction = f.request.wants_true(Refraction::effect);
  f.facts = survey(context.scene, f.pose, f.data, bool(f.sky), refraction);
  // A probe's faces hold what surfaces mirror.
  f.request.sky_hidden = f.sky.studio && !context.face;
  if (job.sky != "none" && !has_light(context.scene) && !f.sky && f.facts.takes_light()) {
    f.request.neutral_light = true;
    add_neutral_light(f.view, f.data);
    f.facts = survey(context.scene, f.pose, f.data, false, refraction);
  }
  size_suns(f.request.look, f.data);
  if (!f.request.look.sun)
    for (LightItem& light : f.data.lights)
      light.is_hard = light.radius_rad < glm::radians(double(asked.knobs.get<SunKnobs>().soft_from_deg));
  if (auto fine = check_divided(f); !fine) return std::unexpected(fine.error());
  f.facts.image_light = f.facts.environment && f.facts.takes_light() && f.request.wants_true("ibl");
  if (f.request.draws_probes() && !f.request.neutral_light && f.facts.takes_light())
    f.facts.probes = uint32_t(f.request.look.probes.size());
  if (!asked.occlusion_note.empty() && AmbientOcclusion::shades(f.facts, f.request))
    f.notes.push_back(asked.occlusion_note);
  f.notes.insert(f.notes.end(), f.view.notes.begin(), f.view.notes.end());
  f.notes.insert(f.notes.end(), f.pose.warnings.begin(), f.pose.warnings.end());
  if (f.request.neutral_light)
    f.notes.push_back(
        "the scene has no light and no sky is given: a neutral light is used so that it is seen (--sky sets one)");
  if (f.facts.draw_items == 0)
    f.notes.push_back("nothing is visible at this time: the image holds the background alone");
  for (const PosedMetaballs& body : f.data.metaballs)
    if (body.lattice.enlarged)
      f.notes.push_back(
          fmt::format("{} is polygonised in cells of {:.4g} m, larger than asked for: there would be more "
                      "than {} blocks of them (metaballs.cell)",
                      quoted_name(context.scene.nodes[body.node].name), body.lattice.cell_m, most_metaball_blocks));
  end_lights(asked.knobs.get<LightRangeKnobs>(), context.scene, f);
  // What was added since is of no group.
  if (!f.request.light_groups.empty())
    f.light_group_of.resize(f.data.lights.size(), uint32_t(f.request.light_groups.size() - 1));
  f.posed_at_allocations = heap_allocations();
  return {};
}

Expected<SurveyedFrame> survey_frame(const Job& job, const Scene& scene, double time_s) {
  const auto look = look_of(job, time_s);
  if (!look) return std::unexpected(look.error());
  const auto sky = JobSky::read_logged(job, *look, scene);
  if (!sky) return std::unexpected(sky.error());
  const GeometryLayout none;
  const PlanContext context{scene, none, &*sky};
  const auto asked = ask_frame(job, context, WantedOutputs{}, time_s);
  if (!asked) return std::unexpected(asked.error());
  SurveyedFrame frame;
  if (auto surveyed = survey_frame(*asked, context, time_s, frame); !surveyed) return std::unexpected(surveyed.error());
  return frame;
}

}  // namespace candela
