#include "plan/ask_frame.h"

#include <fmt/format.h>

#include <bit>

#include "job/background.h"
#include "job/choose_occlusion.h"
#include "job/choose_transparency.h"
#include "job/job_look.h"
#include "job/light_groups.h"
#include "job/picture_window.h"
#include "passes/post/resolve.h"
#include "passes/post/supersample.h"
#include "passes/shared/knob_values.h"
#include "plan/choose_sides.h"
#include "plan/probe_image.h"

namespace candela {
namespace {

// The part of an exposure that is in the linear pictures: enough to keep bright light within a half's range, little
// enough that nothing leaves a float's. Tone mapping applies the rest.
constexpr float most_pre_exposure_ev = 20;

FrameRequest make_request(const Job& job, const KnobValues& knobs, const WantedOutputs& wanted, double time_s,
                          Look look) {
  const DisplayLook display = display_look(job, look);
  FrameRequest request;
  request.look = std::move(look);
  const PictureWindow window = picture_window(job);
  request.width_px = window.width_px;
  request.height_px = window.height_px;
  if (!window.is_whole()) request.region = window.part;
  // Supersampling takes the place of multisampling.
  request.samples = knobs.get<Supersample::Knobs>().pictures() > 1 ? 1 : knobs.get<Resolve::Knobs>().samples;
  request.want_linear = wanted.linear;
  request.want_display = wanted.display;
  request.layers = wanted.linear ? job.layers : std::vector<std::string>{};
  // An image of the frame is of the frame as it would be without the view.
  if (!image_of_view(job.view)) request.view = job.view;
  request.view_is_light = layer_form(request.view) == LayerForm::light;
  std::vector<std::string> groups = light_group_layers(job);
  if (wanted.linear) request.layers.insert(request.layers.end(), groups.begin(), groups.end());
  request.view_alone = wanted.display && request.view != "beauty" && !request.has_layer(request.view);
  if (wanted.linear || (wanted.display && std::ranges::find(groups, request.view) != groups.end()))
    request.light_groups = std::move(groups);
  if (request.view_alone) request.layers.push_back(request.view);
  request.technique = job.technique;
  request.open_sides = job.sides == "open";
  request.transparency = job.transparency;
  request.quality = job.quality;
  request.effects = job.effects;
  request.tonemap = display.curve;
  request.exposure_ev = display.exposure_ev;
  request.pre_exposure_ev = std::clamp(display.exposure_ev, -most_pre_exposure_ev, most_pre_exposure_ev);
  request.display_bits = wanted.display_bits;
  request.for_files = wanted.files;
  request.exr_float = job.exr_float;
  request.look_nonfinite = wanted.files && !job.allow_nonfinite;
  request.shows_through = shows_through(job, request.look);
  if (const auto background = parse_background(job.background); background && request.shows_through)
    request.behind_rgb = background->display_rgb;
  request.dither = job.dither;
  // Noise differs from frame to frame, and depends on nothing but the job and the time.
  const uint64_t noise = job.seed ^ std::bit_cast<uint64_t>(time_s);
  request.noise_seed = uint32_t(noise ^ (noise >> 32));
  request.still_seed = uint32_t(job.seed ^ (job.seed >> 32));
  return request;
}

// The frame as a part of a picture: one sample a pixel, for it has as many as there are frames, and the exposure of the
// picture's time. Subframes have no output but the layers that are light, as sums.
Expected<void> take_subframe(const Subframe& subframe, const PlanContext& context, AskedFrame& asked) {
  FrameRequest& request = asked.request;
  request.part = {.role = subframe.role, .index = subframe.index, .count = subframe.count};
  request.part.width_px = request.width_px, request.part.height_px = request.height_px;
  if (subframe.role != SubframePart::Role::subframe) return {};
  request.samples = 1;
  auto look = context.look ? context.look->at(subframe.picture_s) : look_of(asked.job, subframe.picture_s);
  if (!look) return std::unexpected(look.error());
  expose_by_camera(asked.job, *look);
  request.exposure_ev = display_look(asked.job, *look).exposure_ev;
  request.pre_exposure_ev = std::clamp(request.exposure_ev, -most_pre_exposure_ev, most_pre_exposure_ev);
  request.noise_seed ^= 0x9e3779b9u * (subframe.index + 1);
  std::erase_if(request.layers, [](const std::string& layer) { return !is_summed(layer); });
  return {};
}

// The job with names where it says auto, for a device as the context's.
Job without_auto(Job job, const Scene& scene, std::vector<std::string>& notes) {
  if (job.technique == auto_technique) {  // no device is open
    job.technique = quickest_technique(true, false).name;
    notes.push_back("technique auto: without a device the plan is that of " + job.technique);
  }
  if (job.transparency == auto_transparency) job.transparency = choose_transparency(scene, job, 1, {}).name;
  if (job.sides == "auto") {
    const ChosenSides chosen = choose_sides(scene, job);
    job.sides = chosen.name;
    if (!chosen.why.empty())
      notes.push_back(
          fmt::format("light passes single-sided faces from behind, because {} (--sides block stops it)", chosen.why));
  }
  return job;
}

}  // namespace

Expected<AskedFrame> ask_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted, double time_s) {
  if (auto fine = check_job(job); !fine) return std::unexpected(fine.error());
  AskedFrame asked;
  asked.job = without_auto(job, context.scene, asked.notes);
  auto knobs = frame_knobs(asked.job);
  if (!knobs) return std::unexpected(knobs.error());
  asked.knobs = std::move(*knobs);
  if (int& method = asked.knobs.get<OcclusionKnobs>().method; method == OcclusionKnobs::automatic) {
    const ChosenOcclusion chosen =
        context.occlusion ? *context.occlusion : choose_occlusion(context.scene, asked.job.animation);
    method = chosen.method;
    asked.occlusion_note = fmt::format("occlusion.method auto: {}, because {}",
                                       method == OcclusionKnobs::by_rays ? "rays" : "screen", chosen.why);
  }
  asked.technique = &*std::ranges::find(techniques(), asked.job.technique, &Technique::name);
  auto look = context.look_now ? Expected<Look>(*context.look_now)
              : context.look   ? context.look->at(time_s)
                               : look_of(asked.job, time_s);
  if (!look) return std::unexpected(look.error());
  if (context.face) look = seen_by_probe(std::move(*look));
  expose_by_camera(asked.job, *look);
  asked.request = make_request(asked.job, asked.knobs, wanted, time_s, std::move(*look));
  const auto camera = picture_camera(asked.job, asked.request.look);
  if (!camera) return std::unexpected(camera.error());
  if (gathers(*camera, asked.knobs.get<SubframesKnobs>()) && !context.face)
    asked.request.motion_share = camera->shutter_s / asked.job.motion_s;
  if (context.subframe)
    if (auto fine = take_subframe(*context.subframe, context, asked); !fine) return std::unexpected(fine.error());
  if (!asked.request.look.bloom && asked.request.names_effect("bloom")) asked.request.look.bloom = Bloom{};
  return asked;
}

}  // namespace candela
