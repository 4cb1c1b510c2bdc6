#include "session/draw_probes.h"

#include <cstring>

#include "base/check.h"
#include "base/files.h"
#include "passes/surfaces/probe_knobs.h"
#include "plan/probe_image.h"

namespace candela {
namespace {

Expected<ProbeFace> draw_face(const Job& job, PlannedFrame& planned, gpu::FrameRunner& runner, GpuScene& gpu_scene,
                              std::vector<std::string>& warnings) {
  GpuScene::Uploaded uploaded;
  gpu_scene.upload(planned, uploaded);
  warnings.insert(warnings.end(), uploaded.warnings.begin(), uploaded.warnings.end());
  if (const auto prepared = runner.prepare(planned.graph()); !prepared) return std::unexpected(prepared.error());
  const gpu::FrameRun run = runner.run(planned.graph(), uploaded.imports, {}, uploaded.keep);
  ProbeFace face(size_t(job.width_px) * size_t(job.height_px) * 4);
  for (const FrameOutput& output : planned.made->outputs) {
    if (output.layer != "beauty") continue;
    CHECK(output.format == VK_FORMAT_R32G32B32A32_SFLOAT);
    const std::span<const std::byte> bytes = run.readbacks.at(output.resource)->bytes();
    CHECK(bytes.size() >= face.size() * sizeof(float));
    std::memcpy(face.data(), bytes.data(), face.size() * sizeof(float));
  }
  return face;
}

Expected<DecodedImage> draw_probe(const ReflectionProbe& probe, const ProbeKnobs& knobs, const Job& job,
                                  PlanContext context, gpu::FrameRunner& runner, GpuScene& gpu_scene,
                                  std::vector<std::string>& warnings) {
  std::array<ProbeFace, 6> faces;
  double pre_exposure = 1;
  for (int f = 0; f < 6; ++f) {
    const View view = probe_view(probe, f, knobs);
    context.face = &view, context.subframe = nullptr;
    auto planned = plan_frame(job, context, WantedOutputs{}, probe.time_s);
    if (!planned) return std::unexpected(planned.error());
    context.rays = planned->rays;
    pre_exposure = planned->upload.constants.pre_exposure;
    auto face = draw_face(job, *planned, runner, gpu_scene, warnings);
    if (!face) return std::unexpected(face.error());
    faces[size_t(f)] = std::move(*face);
  }
  size_t dropped = 0;
  DecodedImage image = probe_image(faces, knobs, float(1 / pre_exposure), dropped);
  if (dropped > 0)
    warnings.push_back(
        fmt::format("{} texels of a reflection probe are not finite or beyond 1e30: they are black in it", dropped));
  return image;
}

}  // namespace

Expected<void> draw_probes(const Job& job, PlanContext context, const PlannedFrame& planned, gpu::FrameRunner& runner,
                           GpuScene& gpu_scene, std::vector<std::string>& warnings) {
  const Job of_probes = probe_job(job, planned.probes);
  std::vector<FilteredSky> filtered;
  for (const ReflectionProbe& probe : planned.request.look.probes) {
    const auto image = draw_probe(probe, planned.probes, of_probes, context, runner, gpu_scene, warnings);
    if (!image) return std::unexpected(image.error());
    filtered.push_back(filtered_sky(*image, probe_filter(planned.probes, planned.image_light), cache_folder()));
  }
  gpu_scene.probes().load(filtered);
  return {};
}

}  // namespace candela
