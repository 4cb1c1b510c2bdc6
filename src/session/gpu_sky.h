#pragma once
#include <map>
#include <memory>
#include <vector>

#include "gpu/bindless.h"
#include "gpu/device.h"
#include "gpu/resources.h"
#include "plan/plan_frame.h"
#include "sky/prefilter_sky.h"
#include "sky/sky_sum.h"

namespace candela {

// Bindless textures that a sky takes, of each frame in flight and of the one that is being made.
inline constexpr size_t gpu_sky_textures = 5;

// Of octahedral maps, and the shape of one.
VkSamplerCreateInfo sky_map_sampler();
gpu::TextureData sky_map_shape(VkFormat format, uint32_t width, uint32_t height);
// A sky goes to the device in pieces: staging memory as large as it would be the most that a small frame takes.
inline constexpr uint64_t sky_staging_bytes = 1 << 20;

// Skies on a device: the image, the image as the background shows it, and what surfaces reflect of it. What a frame
// uses is held by the frame, so that the next may have another sky. Where weights alone change, the parts' maps are
// summed again and nothing is filtered: into what no frame in flight uses, without waiting for the device.
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
    std::unique_ptr<gpu::Uploader> uploader;  // of a sum
  };
  struct Maps : Indexed {
    using Indexed::Indexed;
    gpu::Texture sky, irradiance, lobes;
    gpu::Buffer table;  // slices, then lights
    Hash128 key;
    IblKnobs knobs;
    shared::ImageLight light{};
    std::unique_ptr<gpu::Uploader> uploader;  // of a sum, and how large its maps are
    uint32_t width = 0, height = 0;
  };
  std::shared_ptr<Picture> make_picture(const FrameSky& sky);
  std::shared_ptr<Maps> make_maps(const FrameSky& sky, const IblKnobs& knobs);
  std::shared_ptr<Picture> sum_picture(const FrameSky& sky);
  std::shared_ptr<Maps> sum_maps(const FrameSky& sky, const IblKnobs& knobs);
  const FilteredSky& filtered_part(const SkyImage& image, const IblKnobs& knobs);
  void load_filtered(Maps& maps, const FrameSky& sky);
  void load_divided(Maps& maps, const FrameSky& sky);
  void load_table(Maps& maps, gpu::Uploader& uploader, const std::vector<shared::SkySlice>& slices,
                  std::vector<shared::SkyLight> lights);
  // What a buffer of the maps' own holds, and how many of the lights count. Nothing is submitted.
  void add_table(Maps& maps, gpu::Uploader& uploader, std::span<const std::byte> slices,
                 std::span<const std::byte> lights, uint32_t count);

  gpu::Device& device_;
  gpu::Bindless& bindless_;
  std::shared_ptr<Picture> picture_;
  std::shared_ptr<Maps> maps_;
  // Sums of this frame and of those in flight; others are free.
  std::vector<std::shared_ptr<Picture>> pictures_;
  std::vector<std::shared_ptr<Maps>> summed_maps_;
  gpu::TextureData chain_;
  std::vector<WeightedSky> weighted_;
  std::vector<shared::SkyLight> lights_;
  // Of skies that are sums, by content and knobs; a few.
  struct Filtered {
    Hash128 content;
    IblKnobs knobs;
    std::unique_ptr<FilteredSky> sky;
  };
  std::vector<Filtered> filtered_;
};

}  // namespace candela
