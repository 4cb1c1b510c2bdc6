#include "plan/pack_frame.h"

#include "job/background.h"
#include "passes/surfaces/refraction.h"
#include "plan/posed_scene.h"
#include "plan/probe_image.h"
#include "scene/neutral_light.h"

namespace candela {
namespace {

glm::vec4 exposed(const BackgroundChoice& background, float pre_exposure) {
  const auto& [r, g, b, a] = background.linear;
  return {r * pre_exposure, g * pre_exposure, b * pre_exposure, a};
}

}  // namespace

Expected<void> pack_frame(const AskedFrame& asked, const SurveyedFrame& frame, const PlanContext& context,
                          double time_s, PackedFrame& packed) {
  const auto background = parse_background(asked.job.background);
  if (!background) return std::unexpected(background.error());
  const DevicePose& on_device = frame.on_device;
  packed.light_instances = on_device.lights ? on_device.lights->instance_count : 0;
  packed.mesh_instances = on_device.instances ? on_device.instances->instance_count : 0;
  const bool refraction = frame.request.wants_true(Refraction::effect);
  make_draw_list(context.scene, frame.pose, frame.data, refraction, packed.draws);
  const AmbientSh ambient = frame.sky                     ? frame.sky.ambient()
                            : frame.request.neutral_light ? neutral_ambient()
                                                          : AmbientSh{};
  make_frame_upload(context.scene, frame.pose, frame.view, frame.data, packed.draws, context.layout, frame.request,
                    ambient, packed.upload);
  if (asked.technique->keys != Technique::Keys::none) add_batches(packed.draws, packed.upload);
  packed.traces_keys = asked.technique->keys == Technique::Keys::traced && packed.upload.batch_count > 0;
  if (packed.traces_keys) add_triangle_numbers(packed.draws, packed.upload);
  if (frame.request.wants_motion() && !context.face) {
    const auto before = pose_before(context.scene, asked.job, time_s, frame.pose);
    if (!before) return std::unexpected(before.error());
    add_reliefs_before(frame.pose, before->pose, packed.upload);
    add_motion(frame.data, frame.view, before->data, before->view, packed.upload);
  }
  shared::FrameConstants& constants = packed.upload.constants;
  place_probes(std::span(frame.request.look.probes).first(frame.facts.probes), frame.view, constants.probes);
  constants.background = exposed(*background, constants.pre_exposure);
  return {};
}

}  // namespace candela
