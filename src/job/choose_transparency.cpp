#include "job/choose_transparency.h"

#include <fmt/format.h>

#include "passes/surfaces/transparent.h"
#include "passes/transparency/fragments.h"
#include "passes/transparency/moments.h"
#include "scene/sum_over_instances.h"

namespace candela {
namespace {

uint64_t primitives(const MeshSection& section) {
  switch (section.topology) {
    case Topology::triangles:
      return section.index.size() / 3;
    case Topology::lines:
      return section.index.size() / 2;
    case Topology::points:
      break;
  }
  return section.index.size();
}

bool is_blended(const Scene& scene, const MeshSection& section) {
  const Material& material = section.material < 0 ? scene.default_material : scene.materials[size_t(section.material)];
  return material.alpha_mode == AlphaMode::blend;
}

}  // namespace

uint64_t blended_primitives(const Scene& scene) {
  return sum_over_instances(scene, [&](const MeshSection& section) -> uint64_t {
    return is_blended(scene, section) ? primitives(section) : 0;
  });
}

ChosenTransparency choose_transparency(const Scene& scene, const Job& job, int samples,
                                       const TransparencyDevice& device) {
  const uint64_t count = blended_primitives(scene);
  if (count == 0) return {std::string(Transparent::method), {}};
  const auto moments = [](std::string why) { return ChosenTransparency{std::string(Moments::method), std::move(why)}; };
  if (!device.stores_fragments)
    return moments("the device cannot store the surfaces of a pixel, which the exact method, layers, does");
  Fragments most;
  most.knobs = Fragments::most();
  constexpr uint64_t pixels_of_a_quad = 4;
  if (count > most.room() / pixels_of_a_quad)
    return moments(
        fmt::format("{} blended triangles are more than layers, the exact method, holds in four pixels", count));
  const uint64_t needed =
      Fragments::memory_bytes(count * pixels_of_a_quad, uint64_t(job.width_px) * uint64_t(job.height_px), samples);
  constexpr uint64_t mib = 1024 * 1024;
  if (device.memory_bytes > 0 && needed > device.memory_bytes / 4)
    return moments(fmt::format("layers, the exact method, may take {} MiB, more than a quarter of the device's {} MiB",
                               needed / mib, device.memory_bytes / mib));
  return {std::string(Fragments::method), "it is exact"};
}

}  // namespace candela
