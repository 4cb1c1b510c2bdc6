#include "session/gpu_probes.h"

#include "base/check.h"
#include "session/gpu_sky.h"

namespace candela {

GpuProbes::~GpuProbes() { clear(); }

void GpuProbes::clear() {
  for (const uint32_t index : indices_) bindless_.remove_sampled(index);
  indices_.clear();
  images_.clear();
}

uint32_t GpuProbes::add(const gpu::Texture& texture) {
  indices_.push_back(bindless_.add_sampled(texture.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL));
  return indices_.back();
}

void GpuProbes::load(const std::vector<FilteredSky>& probes) {
  CHECK(!probes.empty() && probes.size() <= shared::most_probes);
  clear();
  gpu::Uploader uploader(device_);
  const auto upload = [&](VkFormat format, uint32_t width, uint32_t height, const std::vector<float>& texels,
                          const char* name) {
    const gpu::TextureData shape = sky_map_shape(format, width, height);
    gpu::Texture texture(device_, shape, name);
    uploader.to_texture(texture, shape, std::vector(texels));
    return texture;
  };
  for (const FilteredSky& probe : probes) {
    CHECK(probe.width == probes[0].width && probe.height == probes[0].height);
    images_.push_back(upload(VK_FORMAT_R32G32B32A32_SFLOAT, probe.width, probe.height, probe.texels, "probe"));
  }
  constexpr uint32_t size = shared::sky_lobe_size;
  lobes_ = upload(VK_FORMAT_R32G32B32A32_SFLOAT, size, size, probes[0].lobes, "probe.lobes");
  const auto slices = std::as_bytes(std::span(probes[0].slices));
  slices_ = gpu::Buffer(
      device_, slices.size(),
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
      gpu::Buffer::Memory::device, gpu::Device::Purpose::scene, "probe.slices");
  uploader.to_buffer(slices_, 0, slices);
  uploader.flush();
  for (const gpu::Texture& image : images_) add(image);
  add(lobes_);
  sampler_ = bindless_.add_sampler(sky_map_sampler());
}

void GpuProbes::write(shared::ProbeLights& lights) const {
  lights.slices = slices_.address();
  lights.lobe_texture = indices_.back();
  lights.clamp_sampler = sampler_;
  for (size_t i = 0; i < images_.size(); ++i) lights.probe[i].texture = indices_[i];
}

}  // namespace candela
