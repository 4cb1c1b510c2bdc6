#pragma once
#include <vector>

#include "gpu/bindless.h"
#include "gpu/resources.h"
#include "shared/probes.h"
#include "sky/prefilter_sky.h"

namespace candela {

// Reflection probes on a device: their filtered images, which stay as they are, and what a frame's constants say of
// them.
class GpuProbes {
 public:
  static constexpr size_t textures = shared::most_probes + 1;  // bindless, at most
  GpuProbes(gpu::Device& device, gpu::Bindless& bindless) : device_(device), bindless_(bindless) {}
  ~GpuProbes();
  // In the look's order, of one size; at least one. They take the place of those before, which no frame in flight may
  // use. Throws GpuError.
  void load(const std::vector<FilteredSky>& probes);
  bool loaded() const { return !images_.empty(); }
  void write(shared::ProbeLights& lights) const;

 private:
  void clear();
  uint32_t add(const gpu::Texture& texture);

  gpu::Device& device_;
  gpu::Bindless& bindless_;
  std::vector<gpu::Texture> images_;
  gpu::Texture lobes_;
  gpu::Buffer slices_;
  std::vector<uint32_t> indices_;  // of the images, then of the lobes
  uint32_t sampler_ = 0;
};

}  // namespace candela
