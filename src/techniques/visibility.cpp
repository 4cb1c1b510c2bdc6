#include "passes/shadows/light_rays.h"
#include "passes/shared/draw_batches.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/put_samples.h"
#include "passes/surfaces/refraction.h"
#include "passes/surfaces/sample_store.h"
#include "passes/surfaces/shade_visible.h"
#include "passes/surfaces/surface_pass.h"
#include "techniques/technique.h"

namespace candela {
namespace {

// Whether something is drawn over the surfaces, sample by sample: then there must be a picture and a depth of samples.
bool drawn_over(const Frame& frame, const SceneInputs& scene) {
  return frame.facts.blend_items > 0 || Refraction{}.needed(frame.facts, frame.request) || draws_lines(scene);
}

}  // namespace

ImageHandle sampled_image(Frame& frame, const SceneInputs& scene, const SampleStore& samples,
                          std::string_view instance) {
  if (samples.buffer) return frame.add(PutSamples{}, {scene, samples}, instance).color;
  if (is_first_picture(instance))
    frame.builder.leave_out(std::string(PutSamples::name), "shaded samples are stored into an image (sample_store.in)");
  return samples.color;
}

Shaded visibility(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
                  std::string_view instance) {
  if (!surfaces.keys) return forward(frame, scene, surfaces, lighting, instance);
  ShadeVisible::In in{scene, surfaces.keys, surfaces.deformed, lighting};
  LightRays::In rays{scene, surfaces.keys, surfaces.deformed, lighting};
  rays.lists.occlusion = {};
  in.lists.records =
      frame.add(LightRays{.rays = lighting.rays, .lists_have_a_cap = scene.light_grid.knobs.cap != 0}, rays, instance)
          .records;
  in.whole = !drawn_over(frame, scene);
  in.draws_sky = frame.facts.environment && !frame.request.sky_hidden;
  const ShadeVisible::Out shaded = frame.add(ShadeVisible{}, in, instance);
  const auto leave_out = [&](std::string_view pass, std::string_view reason) {
    if (is_first_picture(instance)) frame.builder.leave_out(std::string(pass), std::string(reason));
  };
  if (!draws_lines(scene))
    for (const std::string_view pass : {ShadeForward::name, ShadeUnlit::name})
      leave_out(pass, "surfaces are shaded in compute (shade_visible)");
  if (in.whole) {
    leave_out(PutSamples::name, "nothing is drawn over the surfaces: their samples are resolved as they are shaded");
    return {shaded.color, true, true};
  }
  const ImageHandle color = sampled_image(frame, scene, shaded.samples, instance);
  return {draws_lines(scene) ? draw_forward(frame, scene, surfaces, lighting, color, true, instance) : color, true};
}

}  // namespace candela
