#include "session/gpu_sky.h"

#include <cstring>

#include "base/check.h"
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

gpu::TextureData sky_map_shape(VkFormat format, uint32_t width, uint32_t height) {
  gpu::TextureData shape{format, width, height, {}};
  shape.levels.emplace_back();
  return shape;
}

namespace {
// One that no frame in flight uses, else a new one.
template <class T>
std::shared_ptr<T> take_free(std::vector<std::shared_ptr<T>>& all, gpu::Bindless& bindless) {
  for (const auto& one : all)
    if (one.use_count() == 1) return one;
  return all.emplace_back(std::make_shared<T>(bindless));
}
}  // namespace

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
      picture_->shows_suns != frame.sky.shows_suns) {
    const bool as_is = frame.sky.blur_deg <= 0 && (!frame.sky.shows_suns || frame.sky.suns.empty());
    picture_ = !frame.sky.is_plain() && as_is ? sum_picture(frame.sky) : make_picture(frame.sky);
  }
  if (frame.sky.is_plain()) pictures_.clear(), summed_maps_.clear();
  keep.push_back(picture_);
  c.sky_texture = picture_->image_index, c.sky_background = picture_->background_index;
  c.sky_sampler = bindless_.add_sampler(image_sampler());
  c.sky_size_px = picture_->size_px;
  if (!frame.facts.image_light) return;
  if (!maps_ || maps_->key != key || !(maps_->knobs == frame.image_light))
    maps_ = !frame.sky.is_plain() && IblMethod(frame.image_light.method) != IblMethod::sampled
                ? sum_maps(frame.sky, frame.image_light)
                : make_maps(frame.sky, frame.image_light);
  keep.push_back(maps_);
  c.image_light = maps_->light;
}

std::shared_ptr<GpuSky::Picture> GpuSky::make_picture(const FrameSky& sky) {
  auto made = std::make_shared<Picture>(bindless_);
  made->key = sky.key(), made->blur_deg = sky.blur_deg, made->shows_suns = sky.shows_suns;
  const DecodedImage summed = sky.is_plain() ? DecodedImage{} : sum_of(sky.parts);
  const DecodedImage& image = sky.is_plain() ? sky.parts[0].image->image : summed;
  gpu::Uploader uploader(device_, sky_staging_bytes);
  const auto load = [&](gpu::Texture& texture, DecodedImage from, const char* name) {
    gpu::TextureData data = make_mip_chain(std::move(from), false, true);
    texture = gpu::Texture(device_, data, name);
    uploader.to_texture(texture, std::move(data));
    return made->add(texture);
  };
  made->background_index = made->image_index = load(made->image, image, "sky");
  const bool apart = sky.shows_suns && !sky.suns.empty();
  if (apart || sky.blur_deg > 0) {
    DecodedImage seen = apart ? seen_sum_of(sky.parts) : image;
    if (sky.blur_deg > 0) seen = blurred_sky(seen, glm::radians(sky.blur_deg));
    made->background_index = load(made->background, std::move(seen), "sky.background");
  }
  made->size_px = {image.width, image.height};
  uploader.flush();
  return made;
}

// The weighted sum, as the background shows it too.
std::shared_ptr<GpuSky::Picture> GpuSky::sum_picture(const FrameSky& sky) {
  const DecodedImage& image = sky.parts[0].image->image;
  chain_.format = VK_FORMAT_R32G32B32A32_SFLOAT;
  chain_.width = uint32_t(image.width), chain_.height = uint32_t(image.height);
  if (chain_.levels.empty()) chain_.levels.emplace_back();
  chain_.levels[0].resize(image.pixels.size());
  sum_of(sky.parts, chain_.levels[0]);
  add_float_levels(chain_);
  const glm::vec2 size_px{image.width, image.height};
  std::erase_if(pictures_, [&](const auto& p) { return p->size_px != size_px; });
  const std::shared_ptr<Picture> made = take_free(pictures_, bindless_);
  made->key = sky.key(), made->blur_deg = sky.blur_deg, made->shows_suns = sky.shows_suns;
  made->size_px = size_px;
  size_t bytes = 0;
  for (const auto& level : chain_.levels) bytes += level.size();
  if (!made->uploader) {
    auto uploader = std::make_unique<gpu::Uploader>(device_, bytes + 16);
    made->image = gpu::Texture(device_, chain_, "sky");
    made->background_index = made->image_index = made->add(made->image);
    made->uploader = std::move(uploader);
  }
  made->uploader->restart();
  std::byte* to = made->uploader
                      ->texture_room(made->image, chain_.format, chain_.width, chain_.height,
                                     uint32_t(chain_.levels.size()), uint32_t(sizeof(glm::vec4)))
                      .data();
  for (const auto& level : chain_.levels) {
    std::memcpy(to, level.data(), level.size());
    to += level.size();
  }
  made->uploader->submit();
  return made;
}

std::shared_ptr<GpuSky::Maps> GpuSky::sum_maps(const FrameSky& sky, const IblKnobs& knobs) {
  weighted_.clear();
  for (const SkyPart& part : sky.parts) weighted_.push_back({&filtered_part(*part.image, knobs), part.weight});
  const FilteredSky& first = *weighted_[0].sky;
  for (const WeightedSky& part : weighted_)
    CHECK(part.sky->width == first.width && part.sky->height == first.height &&
          part.sky->irradiance_px == first.irradiance_px);
  sum_lights(weighted_, lights_);
  const uint32_t count = uint32_t(lights_.size());
  // lavapipe 25.0.7 loads from an address even where no lane asks: there is always a light.
  if (lights_.empty()) lights_.emplace_back();
  std::erase_if(summed_maps_, [&](const auto& m) {
    return m->width != first.width || m->height != first.height || !(m->knobs == knobs);
  });
  const std::shared_ptr<Maps> made = take_free(summed_maps_, bindless_);
  Maps& maps = *made;
  shared::ImageLight& light = maps.light;
  const uint32_t side = first.irradiance_px, lobes = shared::sky_lobe_size;
  const auto slice_bytes = std::as_bytes(std::span(first.slices)), light_bytes = std::as_bytes(std::span(lights_));
  const bool is_new = !maps.uploader;
  if (is_new) {
    maps.knobs = knobs, maps.width = first.width, maps.height = first.height;
    const size_t texels = first.texels.size() + first.irradiance.size() + first.lobes.size();
    const size_t most_lights = size_t(knobs.lights) * weighted_.size() + 1;
    auto uploader = std::make_unique<gpu::Uploader>(
        device_, texels * sizeof(float) + slice_bytes.size() + most_lights * sizeof(shared::SkyLight) + 256);
    const auto texture = [&](gpu::Texture& target, VkFormat format, uint32_t width, uint32_t height, const char* name) {
      target = gpu::Texture(device_, sky_map_shape(format, width, height), name);
      return maps.add(target);
    };
    light = {};
    light.pixel_samples = uint32_t(knobs.stretched);
    light.irradiance_texture = shared::absent;
    light.texture = texture(maps.sky, VK_FORMAT_R32G32B32A32_SFLOAT, first.width, first.height, "sky.filtered");
    light.lobe_texture = texture(maps.lobes, VK_FORMAT_R32G32B32A32_SFLOAT, lobes, lobes, "sky.lobes");
    if (side > 0) {
      light.irradiance_texture = texture(maps.irradiance, VK_FORMAT_R32G32B32A32_SFLOAT, side, side, "sky.irradiance");
      light.irradiance_uv = {1 / float(side), float(side - 2) / float(side)};
    }
    light.clamp_sampler = bindless_.add_sampler(sky_map_sampler());
    maps.uploader = std::move(uploader);
  }
  maps.key = sky.key();
  gpu::Uploader& uploader = *maps.uploader;
  uploader.restart();
  const auto sum = [&](gpu::Texture& target, uint32_t width, uint32_t height, std::vector<float> FilteredSky::*map) {
    const VkFormat format = VK_FORMAT_R32G32B32A32_SFLOAT;
    sum_texels(weighted_, map, uploader.texture_room(target, format, width, height, 1, sizeof(glm::vec4)));
  };
  sum(maps.sky, first.width, first.height, &FilteredSky::texels);
  if (side > 0) sum(maps.irradiance, side, side, &FilteredSky::irradiance);
  // By the knobs alone.
  if (is_new) {
    const auto room =
        uploader.texture_room(maps.lobes, VK_FORMAT_R32G32B32A32_SFLOAT, lobes, lobes, 1, uint32_t(sizeof(glm::vec4)));
    CHECK(room.size() == first.lobes.size() * sizeof(float));
    std::memcpy(room.data(), first.lobes.data(), room.size());
  }
  add_table(maps, uploader, slice_bytes, light_bytes, count);
  uploader.submit();
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
  for (const Filtered& known : filtered_)
    if (known.content == image.content && known.knobs == knobs) return *known.sky;
  constexpr size_t most = 6;
  if (filtered_.size() >= most) filtered_.erase(filtered_.begin());
  filtered_.push_back({image.content, knobs,
                       std::make_unique<FilteredSky>(filtered_sky(
                           image.to_filter(), knobs, image.passing ? std::filesystem::path() : cache_folder()))});
  return *filtered_.back().sky;
}

void GpuSky::load_filtered(Maps& maps, const FrameSky& frame_sky) {
  const SkyImage& image = *frame_sky.parts[0].image;
  FilteredSky sky =
      filtered_sky(image.to_filter(), maps.knobs, image.passing ? std::filesystem::path() : cache_folder());
  shared::ImageLight& light = maps.light;
  gpu::Uploader uploader(device_, sky_staging_bytes);
  const auto load = [&](gpu::Texture& texture, VkFormat format, uint32_t width, uint32_t height,
                        std::vector<float>& texels, const char* name) {
    const gpu::TextureData shape = sky_map_shape(format, width, height);
    texture = gpu::Texture(device_, shape, name);
    uploader.to_texture(texture, shape, std::move(texels));
    return maps.add(texture);
  };
  light.texture = load(maps.sky, VK_FORMAT_R32G32B32A32_SFLOAT, sky.width, sky.height, sky.texels, "sky.filtered");
  light.lobe_texture = load(maps.lobes, VK_FORMAT_R32G32B32A32_SFLOAT, shared::sky_lobe_size, shared::sky_lobe_size,
                            sky.lobes, "sky.lobes");
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
  const uint32_t count = uint32_t(lights.size());
  // lavapipe 25.0.7 loads from an address even where no lane asks: there is always a light.
  if (lights.empty()) lights.push_back({});
  add_table(maps, uploader, std::as_bytes(std::span(slices)), std::as_bytes(std::span(lights)), count);
  uploader.flush();
}

void GpuSky::add_table(Maps& maps, gpu::Uploader& uploader, std::span<const std::byte> slice_bytes,
                       std::span<const std::byte> light_bytes, uint32_t count) {
  maps.light.light_count = count;
  if (maps.table.size() < slice_bytes.size() + light_bytes.size())
    maps.table = gpu::Buffer(device_, slice_bytes.size() + light_bytes.size(),
                             VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                                 VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                             gpu::Buffer::Memory::device, gpu::Device::Purpose::scene, "sky.table");
  if (!slice_bytes.empty()) uploader.to_buffer(maps.table, 0, slice_bytes);
  uploader.to_buffer(maps.table, slice_bytes.size(), light_bytes);
  maps.light.slices = maps.table.address();
  maps.light.lights = maps.light.slices + slice_bytes.size();
}

}  // namespace candela
