#include "session/gpu_sky.h"

#include "base/files.h"
#include "passes/surfaces/ibl_knobs.h"
#include "session/mip_chain.h"
#include "sky/blur_sky.h"
#include "sky/sky_sum.h"

namespace candela {
namespace {

// Longitude wraps, the poles do not.
VkSamplerCreateInfo image_sampler() {
  VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
  info.magFilter = info.minFilter = VK_FILTER_LINEAR;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  info.addressModeU = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  info.addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxAnisotropy = 1;
  info.maxLod = VK_LOD_CLAMP_NONE;
  return info;
}
}  // namespace

VkSamplerCreateInfo sky_map_sampler() {
  VkSamplerCreateInfo info = image_sampler();
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = 0.25f;  // both filters and level 0 alone
  return info;
}

gpu::TextureData sky_texture_data(VkFormat format, uint32_t width, uint32_t height, const std::vector<float>& texels) {
  gpu::TextureData data{format, width, height, {}};
  const auto bytes = std::as_bytes(std::span(texels));
  data.levels.emplace_back(bytes.begin(), bytes.end());
  return data;
}

uint32_t GpuSky::Indexed::add(const gpu::Texture& texture) {
  indices.push_back(bindless.add_sampled(texture.view(), VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL));
  return indices.back();
}

void GpuSky::load(const PlannedFrame& frame, shared::FrameConstants& c,
                  std::vector<std::shared_ptr<const void>>& keep) {
  c.sky_texture = c.sky_background = shared::absent;
  if (!frame.sky) return;
  const Hash128 key = frame.sky.key();
  if (!picture_ || picture_->key != key || picture_->blur_deg != frame.sky.blur_deg ||
      picture_->shows_suns != frame.sky.shows_suns)
    picture_ = make_picture(frame.sky);
  keep.push_back(picture_);
  c.sky_texture = picture_->image_index, c.sky_background = picture_->background_index;
  c.sky_sampler = bindless_.add_sampler(image_sampler());
  c.sky_size_px = picture_->size_px;
  if (!frame.facts.image_light) return;
  if (!maps_ || maps_->key != key || !(maps_->knobs == frame.image_light))
    maps_ = make_maps(frame.sky, frame.image_light);
  keep.push_back(maps_);
  c.image_light = maps_->light;
}

std::shared_ptr<GpuSky::Picture> GpuSky::make_picture(const FrameSky& sky) {
  auto made = std::make_shared<Picture>(bindless_);
  made->key = sky.key(), made->blur_deg = sky.blur_deg, made->shows_suns = sky.shows_suns;
  const DecodedImage summed = sky.is_plain() ? DecodedImage{} : sum_of(sky.parts);
  const DecodedImage& image = sky.is_plain() ? sky.parts[0].image->image : summed;
  gpu::Uploader uploader(device_);
  const auto load = [&](gpu::Texture& texture, const DecodedImage& from, const char* name) {
    const gpu::TextureData data = make_mip_chain(from, false, true);
    texture = gpu::Texture(device_, data, name);
    uploader.to_texture(texture, data);
    return made->add(texture);
  };
  made->background_index = made->image_index = load(made->image, image, "sky");
  const bool apart = sky.shows_suns && !sky.suns.empty();
  if (apart || sky.blur_deg > 0) {
    DecodedImage seen = apart ? seen_sum_of(sky.parts) : image;
    if (sky.blur_deg > 0) seen = blurred_sky(seen, glm::radians(sky.blur_deg));
    made->background_index = load(made->background, seen, "sky.background");
  }
  made->size_px = {image.width, image.height};
  uploader.flush();
  return made;
}

std::shared_ptr<GpuSky::Maps> GpuSky::make_maps(const FrameSky& sky, const IblKnobs& knobs) {
  auto maps = std::make_shared<Maps>(bindless_);
  maps->key = sky.key(), maps->knobs = knobs;
  shared::ImageLight& light = maps->light;
  light.texture = light.irradiance_texture = light.lobe_texture = shared::absent;
  const bool sampled = IblMethod(knobs.method) == IblMethod::sampled;
  light.pixel_samples = uint32_t(sampled ? knobs.pixel_samples : knobs.stretched);
  if (IblMethod(knobs.method) == IblMethod::sampled)
    load_divided(*maps, sky);
  else
    load_filtered(*maps, sky);
  return maps;
}

const FilteredSky& GpuSky::filtered_part(const SkyImage& image, const IblKnobs& knobs) {
  const Hash128 key = hash128(fmt::format("{} {} {} {} {} {}", image.content.hex(), int(knobs.method), knobs.lights,
                                          knobs.size_px, knobs.filter_samples, knobs.irradiance_px));
  for (const auto& [known, filtered] : filtered_)
    if (known == key) return *filtered;
  constexpr size_t most = 6;
  if (filtered_.size() >= most) filtered_.erase(filtered_.begin());
  filtered_.emplace_back(key, std::make_unique<FilteredSky>(filtered_sky(
                                  image.to_filter(), knobs, image.passing ? std::filesystem::path() : cache_folder())));
  return *filtered_.back().second;
}

void GpuSky::load_filtered(Maps& maps, const FrameSky& frame_sky) {
  FilteredSky sky;
  if (frame_sky.parts.size() == 1 && frame_sky.is_plain()) {
    const SkyImage& image = *frame_sky.parts[0].image;
    sky = filtered_sky(image.to_filter(), maps.knobs, image.passing ? std::filesystem::path() : cache_folder());
  } else {
    std::vector<WeightedSky> parts;
    for (const SkyPart& part : frame_sky.parts) parts.push_back({&filtered_part(*part.image, maps.knobs), part.weight});
    sky = sum_of(parts);
  }
  shared::ImageLight& light = maps.light;
  gpu::Uploader uploader(device_);
  const auto load = [&](gpu::Texture& texture, VkFormat format, uint32_t width, uint32_t height,
                        const std::vector<float>& texels, const char* name) {
    const gpu::TextureData data = sky_texture_data(format, width, height, texels);
    texture = gpu::Texture(device_, data, name);
    uploader.to_texture(texture, data);
    return maps.add(texture);
  };
  light.texture = load(maps.sky, VK_FORMAT_R32G32B32A32_SFLOAT, sky.width, sky.height, sky.texels, "sky.filtered");
  light.lobe_texture =
      load(maps.lobes, VK_FORMAT_R32G32_SFLOAT, shared::sky_lobe_size, shared::sky_lobe_size, sky.lobes, "sky.lobes");
  if (const uint32_t side = sky.irradiance_px; side > 0) {
    light.irradiance_texture =
        load(maps.irradiance, VK_FORMAT_R32G32B32A32_SFLOAT, side, side, sky.irradiance, "sky.irradiance");
    light.irradiance_uv = {1 / float(side), float(side - 2) / float(side)};
  }
  light.clamp_sampler = bindless_.add_sampler(sky_map_sampler());
  load_table(maps, uploader, sky.slices, sky.lights);
}

void GpuSky::load_divided(Maps& maps, const FrameSky& frame_sky) {
  std::vector<DividedSky> divided;
  for (const SkyPart& part : frame_sky.parts) divided.push_back(divide_sky(part.image->image, maps.knobs));
  const DividedSky sky = frame_sky.is_plain() ? std::move(divided[0]) : sum_of(divided, frame_sky.parts);
  gpu::TextureData data{VK_FORMAT_R32G32B32A32_SFLOAT, uint32_t(sky.rest[0].width), uint32_t(sky.rest[0].height), {}};
  for (const SkyLevel& level : sky.rest) {
    const auto bytes = std::as_bytes(std::span(level.texels));
    data.levels.emplace_back(bytes.begin(), bytes.end());
  }
  maps.sky = gpu::Texture(device_, data, "sky.rest");
  gpu::Uploader uploader(device_);
  uploader.to_texture(maps.sky, data);
  maps.light.texture = maps.add(maps.sky);
  maps.light.rest_px = {sky.rest[0].width, sky.rest[0].height};
  load_table(maps, uploader, {}, sky.lights);
}

void GpuSky::load_table(Maps& maps, gpu::Uploader& uploader, const std::vector<shared::SkySlice>& slices,
                        std::vector<shared::SkyLight> lights) {
  maps.light.light_count = uint32_t(lights.size());
  // lavapipe 25.0.7 loads from an address even where no lane asks: there is always a light.
  if (lights.empty()) lights.push_back({});
  const auto slice_bytes = std::as_bytes(std::span(slices)), light_bytes = std::as_bytes(std::span(lights));
  maps.table = gpu::Buffer(
      device_, slice_bytes.size() + light_bytes.size(),
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
      gpu::Buffer::Memory::device, gpu::Device::Purpose::scene, "sky.table");
  if (!slices.empty()) uploader.to_buffer(maps.table, 0, slice_bytes);
  uploader.to_buffer(maps.table, slice_bytes.size(), light_bytes);
  uploader.flush();
  maps.light.slices = maps.table.address();
  maps.light.lights = maps.light.slices + slice_bytes.size();
}

}  // namespace candela
