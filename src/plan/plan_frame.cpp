#include "plan/plan_frame.h"

#include <bit>
#include <cstring>

#include "base/text.h"
#include "job/not_drawn.h"
#include "passes/post/resolve.h"
#include "passes/post/supersample.h"
#include "passes/shared/knob_values.h"
#include "passes/surfaces/sample_store.h"
#include "plan/plan_graph.h"

namespace candela {
namespace {

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
  f.notes.append(f.SurveyedFrame::notes);
  f.notes.append(f.LitFrame::notes);
  f.notes.append(f.TracedFrame::notes);
  const Supersample::Knobs& supersample = knobs.get<Supersample::Knobs>();
  if (supersample.pictures() > 1 && knobs.get<Resolve::Knobs>().samples > 1)
    f.notes.add("supersampling ({} x {} a pixel) takes the place of multisampling", supersample.grid().x,
                supersample.grid().y);
  if (supersample.pictures() >= 16 && f.rays)
    f.notes.push_back(
        "rays from every sample of every pixel, as at quality exact: candela reference --mode direct is the truth "
        "itself, and on a CPU device the quicker of the two");
  if (const std::string note = probe_note(f); !note.empty()) f.notes.push_back(note);
  std::vector<std::string> missing = not_drawn(f.facts, f.pose);
  if (f.facts.sized_lights > 0 && f.facts.takes_light() && !f.traced.soft_lamps)
    missing.push_back("sizes of point and spot lights (drawn as points: local.method, local.soft)");
  if (!missing.empty()) f.notes.add("not drawn yet (candela reference does): {}", joined(missing));
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

Expected<void> plan_one(const Job& job, const PlanContext& context, const WantedOutputs& wanted, double time_s,
                        PlannedFrame& f) {
  StageClock& clock = f.clock;
  clock.restart();
  clock.begin("animate");
  const auto asked = ask_frame(job, context, wanted, time_s);
  if (!asked) return std::unexpected(asked.error());
  if (auto fine = survey_frame(*asked, context, time_s, f); !fine) return fine;
  if (auto fine = pack_frame(*asked, f, context, time_s, f); !fine) return fine;
  // What is looked at is the frame's own.
  PlanContext lighting = context;
  if (asks_dumps(asked->job, wanted)) lighting.kept_lamps = nullptr;
  if (auto fine = light_frame(*asked, f, f, lighting, clock, f); !fine) return fine;
  clock.begin("trees");
  trace_frame(*asked, f, f, f, context, f);

  clock.begin("plan");
  complete_upload(f, f, f, context.layout.least_light_distance_m, f);
  const auto parts = picture_parts(f.facts, f.request, asked->knobs, f.SurveyedFrame::notes);
  if (parts) cull_beyond(parts->seen, f.view, f.request, f.upload);
  f.notes.clear();
  f.textures = asked->knobs.get<TextureKnobs>();
  f.relief = asked->knobs.get<ReliefKnobs>();
  f.surfaces = asked->knobs.get<SurfaceKnobs>();
  f.image_light = asked->knobs.get<IblKnobs>();
  f.probes = asked->knobs.get<ProbeKnobs>();
  f.stores_samples = context.stores_samples && asked->knobs.get<SampleStoreKnobs>().in != SampleStoreKnobs::buffer;
  if (auto fine = plan_graph(*asked, context, wanted, parts, f); !fine) return std::unexpected(fine.error());
  add_notes(f, asked->knobs);
  clock.end();
  return {};
}

}  // namespace

Expected<void> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted, double time_s,
                          PlannedFrame& frame) {
  if (context.subframe || context.is_whole) return plan_one(job, context, wanted, time_s, frame);
  const auto frames = subframes_of(job, context, time_s);
  if (!frames) return std::unexpected(frames.error());
  if (frames->empty()) return plan_one(job, context, wanted, time_s, frame);
  PlanContext first = context;
  first.subframe = &frames->front();
  auto planned = plan_one(job, first, wanted, first.subframe->time_s, frame);
  if (planned)
    frame.notes.add(
        "the picture is the mean of {} such frames, from {:.6g} to {:.6g} s "
        "(subframes.n, --shutter, --fstop)",
        frames->front().count, frames->front().time_s, (*frames)[frames->size() - 2].time_s);
  return planned;
}

Expected<PlannedFrame> plan_frame(const Job& job, const PlanContext& context, const WantedOutputs& wanted,
                                  double time_s) {
  PlannedFrame frame;
  if (auto planned = plan_frame(job, context, wanted, time_s, frame); !planned) return std::unexpected(planned.error());
  return frame;
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
