#include "scene/scene_images.h"

#include <cstring>

#include "base/check.h"
#include "base/input.h"
#include "base/log.h"
#include "image/environment_file.h"
#include "scene/texture_slots.h"

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

// Roughness from glossiness; occlusion 1, no metal.
DecodedImage rough_of_gloss(const DecodedImage& gloss, float factor) {
  DecodedImage out = gloss;
  out.source_channels = 3;
  if (out.format != DecodedImage::Format::rgba8 && out.format != DecodedImage::Format::rgba16)
    out.format = DecodedImage::Format::rgba16;
  const size_t texels = size_t(gloss.width) * size_t(gloss.height);
  out.pixels.assign(texels * (out.format == DecodedImage::Format::rgba8 ? 4 : 8), std::byte(0));
  for (int y = 0; y < gloss.height; ++y)
    for (int x = 0; x < gloss.width; ++x) {
      const size_t at = (size_t(y) * size_t(gloss.width) + size_t(x)) * 4;
      store(out, at, 1.f);
      store(out, at + 1, 1 - factor * channel_value(gloss, x, y, 3));
      store(out, at + 2, 0.f);
      store(out, at + 3, 1.f);
    }
  return out;
}

// Large squares of colours that no scene has, in every channel far from neutral.
DecodedImage placeholder_image() {
  constexpr int side_px = 64, square_px = 8;
  DecodedImage image{side_px, side_px, DecodedImage::Format::rgba8, 3, {}};
  for (int y = 0; y < side_px; ++y)
    for (int x = 0; x < side_px; ++x) {
      const auto magenta = std::byte((x / square_px + y / square_px) % 2 == 0 ? 255 : 0);
      image.pixels.insert(image.pixels.end(), {magenta, std::byte(0), magenta, std::byte(255)});
    }
  return image;
}

Expected<DecodedImage> decode_stored(const Scene& scene, int image, std::vector<std::string>& warnings) {
  CHECK(image >= 0 && size_t(image) < scene.images.size());
  const SceneImage& stored = scene.images[size_t(image)];
  if (stored.encoded.empty()) return placeholder_image();
  auto decoded = decode_image(stored.encoded, stored.place);
  if (decoded || decoded.error().kind == ErrorKind::out_of_memory) return decoded;
  warnings.push_back(fmt::format("{}: {}", decoded.error().text(), placeholder_note));
  return placeholder_image();
}

uint64_t mesh_bytes(const MeshSection& s) {
  const auto size = [](const auto& values) { return uint64_t(values.size()) * sizeof(values[0]); };
  uint64_t sum = size(s.position) + size(s.normal) + size(s.tangent) + size(s.uv0) + size(s.uv1) + size(s.color) +
                 size(s.joints0) + size(s.joints1) + size(s.weights0) + size(s.weights1) + size(s.index);
  for (const MorphTarget& m : s.morph) sum += size(m.position) + size(m.normal) + size(m.tangent);
  return sum;
}

// Nothing where there is no head that can be read: the placeholder is small.
std::optional<ImageInfo> info_of(const Scene& scene, const SceneImage& image) {
  if (image.glossiness_of >= 0) return info_of(scene, scene.images[size_t(image.glossiness_of)]);
  if (image.merge_occlusion >= 0) {
    const auto a = info_of(scene, scene.images[size_t(image.merge_occlusion)]),
               b = info_of(scene, scene.images[size_t(image.merge_metallic_roughness)]);
    if (!a || !b) return a ? a : b;
    return ImageInfo{std::max(a->width, b->width), std::max(a->height, b->height), 4, std::max(a->bits, b->bits)};
  }
  const auto info = probe_image(image.encoded, image.place);
  return info ? std::optional(*info) : std::nullopt;
}

}  // namespace

Expected<SceneTexture> decode_scene_image(const Scene& scene, int image) {
  CHECK(image >= 0 && size_t(image) < scene.images.size());
  const SceneImage& stored = scene.images[size_t(image)];
  SceneTexture texture;
  if (stored.glossiness_of >= 0) {
    const auto gloss = decode_stored(scene, stored.glossiness_of, texture.warnings);
    if (!gloss) return std::unexpected(gloss.error());
    texture.image = rough_of_gloss(*gloss, stored.glossiness_factor);
    return texture;
  }
  auto first = decode_stored(scene, stored.merge_occlusion < 0 ? image : stored.merge_occlusion, texture.warnings);
  if (!first) return std::unexpected(first.error());
  if (stored.merge_occlusion < 0) {
    texture.image = std::move(*first);
    return texture;
  }
  const auto second = decode_stored(scene, stored.merge_metallic_roughness, texture.warnings);
  if (!second) return std::unexpected(second.error());
  texture.image = merged(*first, *second);
  return texture;
}

Expected<uint64_t> decoded_bytes(const Scene& scene) {
  uint64_t sum = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const MeshSection& section : mesh.sections)
      if (auto fits = charge_decoded(sum, mesh_bytes(section), scene.path + ": " + section.place); !fits)
        return std::unexpected(fits.error());
  std::vector<bool> used(scene.images.size());
  const auto use = [&](const TextureSlot& slot, bool) {
    if (slot) used[size_t(slot.image)] = true;
  };
  for (const Material& material : scene.materials) for_each_slot(material, use);
  for (size_t i = 0; i < used.size(); ++i)
    if (const auto info = used[i] ? info_of(scene, scene.images[i]) : std::nullopt)
      if (auto fits = charge_decoded(sum, decoded_bytes_with_mips(*info), scene.images[i].place); !fits)
        return std::unexpected(fits.error());
  return sum;
}

Expected<DecodedImage> read_sky(const std::filesystem::path& path, const Scene& scene) {
  const auto before = decoded_bytes(scene);
  if (!before) return std::unexpected(before.error());
  std::vector<std::string> warnings;
  auto image = read_environment(path, warnings, *before);
  for (const std::string& warning : warnings) log::warning("{}", warning);
  return image;
}

}  // namespace candela
