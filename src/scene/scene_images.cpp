#include "scene/scene_images.h"

#include <cstring>

#include "base/check.h"

namespace candela {
namespace {

// One channel of a decoded image as numbers in [0, 1] (or unbounded for float images).
float channel_value(const DecodedImage& image, int x, int y, int channel) {
  const size_t at = (size_t(y) * size_t(image.width) + size_t(x)) * 4 + size_t(channel);
  switch (image.format) {
    case DecodedImage::Format::rgba8:
      return float(std::to_integer<uint8_t>(image.pixels[at])) / 255.f;
    case DecodedImage::Format::rgba16: {
      uint16_t v;
      std::memcpy(&v, image.pixels.data() + at * 2, 2);
      return float(v) / 65535.f;
    }
    default: {
      float v;
      std::memcpy(&v, image.pixels.data() + at * 4, 4);
      return v;
    }
  }
}

// Where pixel i of `size` lies among `source` pixels: pixel centres are kept, edges clamp.
struct Tap {
  int first, second;
  float fraction;
};
Tap tap_of(int i, int size, int source) {
  const float position = std::clamp((float(i) + 0.5f) * float(source) / float(size) - 0.5f, 0.f, float(source - 1));
  const int first = std::min(int(position), source - 1);
  return {first, std::min(first + 1, source - 1), position - float(first)};
}

float sampled(const DecodedImage& image, const Tap& x, const Tap& y, int channel) {
  const float top = std::lerp(channel_value(image, x.first, y.first, channel),
                              channel_value(image, x.second, y.first, channel), x.fraction);
  if (y.fraction == 0) return top;
  const float bottom = std::lerp(channel_value(image, x.first, y.second, channel),
                                 channel_value(image, x.second, y.second, channel), x.fraction);
  return std::lerp(top, bottom, y.fraction);
}

void store(DecodedImage& image, size_t at, float value) {
  value = std::clamp(value, 0.f, 1.f);
  if (image.format == DecodedImage::Format::rgba8) {
    image.pixels[at] = std::byte(int(std::lround(value * 255.f)));
  } else {
    const uint16_t v = uint16_t(std::lround(value * 65535.f));
    std::memcpy(image.pixels.data() + at * 2, &v, 2);
  }
}

DecodedImage merged(const DecodedImage& occlusion, const DecodedImage& metallic_roughness) {
  DecodedImage out;
  out.width = std::max(occlusion.width, metallic_roughness.width);
  out.height = std::max(occlusion.height, metallic_roughness.height);
  const bool bytes =
      occlusion.format == DecodedImage::Format::rgba8 && metallic_roughness.format == DecodedImage::Format::rgba8;
  out.format = bytes ? DecodedImage::Format::rgba8 : DecodedImage::Format::rgba16;
  out.source_channels = 3;
  out.pixels.resize(size_t(out.width) * size_t(out.height) * 4 * (bytes ? 1 : 2));
  for (int y = 0; y < out.height; ++y) {
    const Tap oy = tap_of(y, out.height, occlusion.height), my = tap_of(y, out.height, metallic_roughness.height);
    for (int x = 0; x < out.width; ++x) {
      const Tap ox = tap_of(x, out.width, occlusion.width), mx = tap_of(x, out.width, metallic_roughness.width);
      const size_t at = (size_t(y) * size_t(out.width) + size_t(x)) * 4;
      store(out, at, sampled(occlusion, ox, oy, 0));
      store(out, at + 1, sampled(metallic_roughness, mx, my, 1));
      store(out, at + 2, sampled(metallic_roughness, mx, my, 2));
      store(out, at + 3, 1.f);
    }
  }
  return out;
}

Expected<DecodedImage> decode_stored(const Scene& scene, int image) {
  CHECK(image >= 0 && size_t(image) < scene.images.size());
  const SceneImage& stored = scene.images[size_t(image)];
  return decode_image(stored.encoded, stored.place);
}

}  // namespace

Expected<DecodedImage> decode_scene_image(const Scene& scene, int image) {
  CHECK(image >= 0 && size_t(image) < scene.images.size());
  const SceneImage& stored = scene.images[size_t(image)];
  if (stored.merge_occlusion < 0) return decode_stored(scene, image);
  Expected<DecodedImage> occlusion = decode_stored(scene, stored.merge_occlusion);
  if (!occlusion) return occlusion;
  Expected<DecodedImage> metallic_roughness = decode_stored(scene, stored.merge_metallic_roughness);
  if (!metallic_roughness) return metallic_roughness;
  return merged(*occlusion, *metallic_roughness);
}

}  // namespace candela
