#include "session/device_samples.h"

#include "base/text.h"
#include "gpu/sample_counts.h"
#include "job/frame_knobs.h"
#include "passes/post/resolve.h"
#include "passes/shared/scene_inputs.h"
#include "passes/surfaces/sample_store.h"
#include "shared/lights.h"

namespace candela {

std::vector<int> device_samples(const gpu::Device& device) {
  return gpu::sample_counts(device, color_format, depth_format);
}

bool shades_on_cpu(const gpu::Device& device) {
  return device.info().is_cpu && device.info().subgroup_size >= shared::light_chunk_cells;
}

Expected<void> check_samples(const Job& job, const std::vector<int>& possible, const std::string& device) {
  const auto knobs = frame_knobs(job);
  if (!knobs) return std::unexpected(knobs.error());
  const int samples = knobs->get<Resolve::Knobs>().samples;
  if (std::find(possible.begin(), possible.end(), samples) != possible.end()) return {};
  std::vector<std::string> names;
  for (const int n : possible) names.push_back(fmt::format("{}", n));
  return fail(ErrorKind::device, "--samples", "{} has no {} samples a pixel; it has {}", device, samples,
              joined(names));
}

Expected<bool> stores_samples(const Job& job, const gpu::Device& device) {
  const auto knobs = frame_knobs(job);
  if (!knobs) return std::unexpected(knobs.error());
  const int samples = knobs->get<Resolve::Knobs>().samples;
  const bool can = gpu::stores_samples(device, color_format, uint32_t(samples));
  if (!can && samples > 1 && knobs->get<SampleStoreKnobs>().in == SampleStoreKnobs::image)
    return fail(ErrorKind::device, "--set sample_store.in",
                "{} has no multisampled storage images of {} samples; set sample_store.in=buffer", device.info().name,
                samples);
  return can;
}

Expected<TransparencyLimits> transparency_device(const Job& job, const gpu::Device& device) {
  const auto knobs = frame_knobs(job);
  if (!knobs) return std::unexpected(knobs.error());
  TransparencyLimits limits;
  limits.samples = knobs->get<Resolve::Knobs>().samples;
  limits.device.stores_fragments =
      gpu::has_primitive_ids(device.physical()) && (limits.samples == 1 || device.info().post_depth_coverage);
  limits.device.memory_bytes = device.info().memory_bytes;
  return limits;
}

Expected<void> check_traversal(const BvhKnobs& knobs, const gpu::RayExtensions& has, const std::string& device) {
  const bool by_query = knobs.traversal == BvhKnobs::by_query;
  if (!knobs.on_device() || (by_query ? has.queries : has.pipelines)) return {};
  const std::string_view other = by_query && has.pipelines  ? "pipeline or "
                                 : !by_query && has.queries ? "query or "
                                                            : "";
  return fail(ErrorKind::device, "--set bvh.traversal",
              "{} has no {}; set bvh.traversal={}shader, or choose another device with --device", device,
              by_query ? VK_KHR_RAY_QUERY_EXTENSION_NAME : VK_KHR_RAY_TRACING_PIPELINE_EXTENSION_NAME, other);
}

}  // namespace candela
