#include <cmath>

#include "passes/post/bloom.h"
#include "passes/post/exposure.h"
#include "passes/post/motion_blur.h"
#include "passes/post/resolve.h"
#include "passes/post/smooth_edges.h"
#include "passes/post/subframes.h"
#include "passes/post/tonemap.h"
#include "passes/shared/frame_request.h"
#include "passes/shared/light_lists.h"
#include "passes/shared/scene_inputs.h"
#include "passes/volumes/volumetric.h"
#include "techniques/technique.h"

namespace candela {
namespace {

Exposure::In exposure_in(const Frame& frame, const SceneInputs& scene, ImageHandle linear) {
  Exposure::In in{linear, scene.width_px, scene.height_px, Live<AutoExposure>::of(frame.values.auto_exposure),
                  Live<float>::of(frame.values.radiance_scale)};
  return in;
}

Tonemap::In tonemap_in(const Frame& frame, const SceneInputs& scene, ImageHandle linear) {
  const FrameRequest& request = frame.request;
  const auto curves = tone_curve_names();
  Tonemap::In in{linear, scene.width_px, scene.height_px};
  in.curve = ToneCurve(std::find(curves.begin(), curves.end(), request.tonemap) - curves.begin());
  in.bits = uint32_t(request.display_bits);
  in.dither = request.dither;
  in.exposure = Live<float>::of(frame.values.exposure);
  in.seed = Live<uint32_t>::of(frame.values.noise_seed);
  in.behind_rgb = request.behind_rgb;
  in.agx_min_ev = Live<float>::of(frame.values.agx_min_ev);
  in.agx_max_ev = Live<float>::of(frame.values.agx_max_ev);
  return in;
}

BloomPass::In bloom_in(const Frame& frame, const SceneInputs& scene, ImageHandle linear, ImageHandle emission) {
  const FrameRequest& request = frame.request;
  BloomPass::In in{linear, scene.width_px, scene.height_px};
  in.look = Live<Bloom>::of(frame.values.bloom);
  in.exposure = Live<float>::of(frame.values.exposure);
  in.glow_wanted = request.has_layer("bloom");
  in.source = emission;
  return in;
}

ImageHandle published(const Frame& frame, std::string_view name) {
  for (const auto& [layer, image] : frame.builder.published())
    if (layer == name) return image;
  return {};
}

// A layer of light in the place of beauty, exposed as beauty is.
void show_layer(const Frame& frame, Tonemap::In& shown) {
  shown.color = {};
  shown.covers = true;
  shown.color = published(frame, frame.request.view);
}

}  // namespace

void post(Frame& frame, const SceneInputs& scene, const Surfaces& surfaces, const Lighting& lighting,
          ImageHandle radiance, bool resolved, ImageHandle emission) {
  const FrameRequest& request = frame.request;
  const bool is_mean = request.part.role == SubframePart::Role::mean;
  ImageHandle picture = radiance;
  if (resolved && scene.samples > 1)
    frame.builder.leave_out(std::string(Resolve::name),
                            "the surfaces' samples are resolved already (shade_visible, resolve.opaque)");
  else if (!is_mean)  // of one sample the pass says itself why it is left out
    picture =
        newest(frame.add(Resolve{}, {radiance, scene.width_px, scene.height_px, scene.samples}).resolved, radiance);
  VolumetricLight::In volumetric{scene, picture, surfaces.looked_up, lighting.unoccluded()};
  volumetric.look = Live<Volumetric>::of(frame.values.volumetric);
  volumetric.layer_wanted = frame.request.has_layer("volumetric");
  const VolumetricLight::Out aired = is_mean ? VolumetricLight::Out{} : frame.add(VolumetricLight{}, volumetric);
  ImageHandle linear = newest(aired.color, picture);
  if (request.part.role == SubframePart::Role::subframe) {
    add_to_sum(frame, scene, "beauty", linear);
    if (request.draws_volumetric() && volumetric.layer_wanted) add_to_sum(frame, scene, "volumetric", aired.layer);
    return;
  }
  frame.add(Subframes{}, {});
  if (is_mean) {
    linear = picture = mean_of(frame, scene, "beauty");
    if (request.draws_volumetric() && volumetric.layer_wanted)
      frame.builder.publish("volumetric", mean_of(frame, scene, "volumetric"));
  } else {
    frame.add(SubframesMean{}, {});
  }
  MotionBlur::In moved{scene, linear, {}, surfaces.looked_up};
  moved.motion = published(frame, "motion");
  moved.share = Live<float>::of(frame.values.motion_share), moved.seed = Live<uint32_t>::of(frame.values.noise_seed);
  linear = newest(frame.add(MotionBlur{}, moved).color, linear);
  SmoothEdges::In edges{linear, scene.width_px, scene.height_px, Live<float>::of(frame.values.exposure)};
  linear = newest(frame.add(SmoothEdges{}, edges).color, linear);
  const ImageHandle bloomed = newest(frame.add(BloomPass{}, bloom_in(frame, scene, linear, emission)).color, linear);
  Tonemap::In shown = tonemap_in(frame, scene, bloomed);
  if (frame.request.view != "beauty") show_layer(frame, shown);
  shown.automatic = frame.add(Exposure{}, exposure_in(frame, scene, linear)).exposure;
  // Where nothing else reads the resolved picture, its samples are read once, and it is left out.
  const bool only_shown = !request.want_linear && !request.look_nonfinite && !shown.automatic;
  if (only_shown && !is_mean && shown.color == picture && picture != radiance)
    shown.color = radiance, shown.samples = scene.samples;
  const ImageHandle display = frame.add(Tonemap{}, shown).display;

  const std::optional<Bloom>& bloom = frame.request.look.bloom;
  read_back(frame, scene, bloom && bloom->in_beauty ? bloomed : linear, display);
}

}  // namespace candela
