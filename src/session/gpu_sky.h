#pragma once
#include <map>
#include <memory>
#include <vector>

#include "gpu/bindless.h"
#include "gpu/device.h"
#include "gpu/resources.h"
#include "plan/plan_frame.h"
#include "sky/prefilter_sky.h"

namespace candela {

// Bindless textures that a sky takes, of each frame in flight and of the one that is being made.
inline constexpr size_t gpu_sky_textures = 5;

// Of octahedral maps, and such a map with one level.
VkSamplerCreateInfo sky_map_sampler();
gpu::TextureData sky_texture_data(VkFormat format, uint32_t width, uint32_t height, const std::vector<float>& texels);

// Skies on a device: the image, the image as the background shows it, and what surfaces reflect of it. What a frame
// uses is held by the frame, so that the next may have another sky. Where weights alone change, the parts' maps are
// summed again and nothing is filtered.
class GpuSky {
 public:
  GpuSky(gpu::Device& device, gpu::Bindless& bindless) : device_(device), bindless_(bindless) {}
  // Makes what the frame's sky needs and is not here yet, and writes its indices. Throws GpuError.
  void load(const PlannedFrame& frame, shared::FrameConstants& constants,
            std::vector<std::shared_ptr<const void>>& keep);

 private:
  // Indices are given back when they are no longer held.
  struct Indexed {
    explicit Indexed(gpu::Bindless& b) : bindless(b) {}
    Indexed(const Indexed&) = delete;
    Indexed& operator=(const Indexed&) = delete;
    ~Indexed() {
      for (const uint32_t index : indices) bindless.remove_sampled(index);
    }
    uint32_t add(const gpu::Texture& texture);
    gpu::Bindless& bindless;
    std::vector<uint32_t> indices;
  };
  struct Picture : Indexed {
    using Indexed::Indexed;
    gpu::Texture image, background;
    Hash128 key;
    double blur_deg = 0;
    bool shows_suns = true;
    uint32_t image_index = shared::absent, background_index = shared::absent;
    glm::vec2 size_px{0};
  };
  struct Maps : Indexed {
    using Indexed::Indexed;
    gpu::Texture sky, irradiance, lobes;
    gpu::Buffer table;  // slices, then lights
    Hash128 key;
    IblKnobs knobs;
    shared::ImageLight light{};
  };
  std::shared_ptr<Picture> make_picture(const FrameSky& sky);
  std::shared_ptr<Maps> make_maps(const FrameSky& sky, const IblKnobs& knobs);
  const FilteredSky& filtered_part(const SkyImage& image, const IblKnobs& knobs);
  void load_filtered(Maps& maps, const FrameSky& sky);
  void load_divided(Maps& maps, const FrameSky& sky);
  void load_table(Maps& maps, gpu::Uploader& uploader, const std::vector<shared::SkySlice>& slices,
                  std::vector<shared::SkyLight> lights);

  gpu::Device& device_;
  gpu::Bindless& bindless_;
  std::shared_ptr<Picture> picture_;
  std::shared_ptr<Maps> maps_;
  // Of skies that are sums, by content and knobs; a few.
  std::vector<std::pair<Hash128, std::unique_ptr<FilteredSky>>> filtered_;
};

}  // namespace candela
