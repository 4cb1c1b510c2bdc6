#include "gltf/textures.h"

#include "gltf/named_files.h"
#include "image/ktx2.h"
#include "scene/scene_images.h"
#include "scene/texture_slots.h"

namespace candela::gltf {
namespace {

Wrap wrap_of(int mode) {
  return mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? Wrap::clamp
         : mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? Wrap::mirror
                                                         : Wrap::repeat;
}

// The image that a texture shows: an extension's, the one that loses least first, else `source`. Extensions whose
// formats are not read fall back to `source`, as they say.
int image_of(Document& document, int texture, const std::string& user) {
  const Json& t = document.json["textures"][size_t(texture)];
  const Json* images = member(document.json, "images");
  const size_t count = images ? images->size() : 0;
  const std::string path = fmt::format("/textures/{}", texture);
  for (const char* name : {"EXT_texture_webp", "KHR_texture_basisu"})
    if (const Json* use = extension(t, name))
      if (const int image = index_of(document, *use, "source", count, fmt::format("{}/extensions/{}", path, name));
          image >= 0)
        return image;
  const int image = index_of(document, t, "source", count, path);
  if (image < 0)
    document.warn(user, "{} has no image in a format that is read (PNG, JPEG, WebP, KTX2); nothing is drawn for it",
                  named(path, t));
  return image;
}

void apply_transform(Document& document, const Json& info, const std::string& path, TextureSlot& slot) {
  const Json* transform = extension(info, "KHR_texture_transform");
  if (!transform) return;
  const std::string where = path + "/extensions/KHR_texture_transform";
  slot.offset = vector_of(document, *transform, "offset", slot.offset, where);
  slot.scale = vector_of(document, *transform, "scale", slot.scale, where);
  slot.rotation_rad = float(number(document, *transform, "rotation", 0, where));
  if (const int uv_set = index_of(document, *transform, "texCoord", INT32_MAX, where); uv_set >= 0)
    slot.uv_set = uv_set;
}

}  // namespace

void import_samplers(Document& document, Scene& scene) {
  scene.samplers.emplace_back();
  for (const tinygltf::Sampler& s : document.model.samplers) {
    Sampler sampler;
    sampler.wrap_u = wrap_of(s.wrapS);
    sampler.wrap_v = wrap_of(s.wrapT);
    sampler.mag = s.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST ? Filter::nearest : Filter::linear;
    const int min = s.minFilter;
    sampler.min = min == TINYGLTF_TEXTURE_FILTER_NEAREST || min == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST ||
                          min == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR
                      ? Filter::nearest
                      : Filter::linear;
    sampler.mip =
        min == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST || min == TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST
            ? Filter::nearest
            : Filter::linear;
    sampler.mipmaps = min != TINYGLTF_TEXTURE_FILTER_NEAREST && min != TINYGLTF_TEXTURE_FILTER_LINEAR;
    scene.samplers.push_back(sampler);
  }
}

TextureSlot texture_slot(Document& document, const Json& object, const char* key, const std::string& path,
                         std::vector<bool>& image_used) {
  TextureSlot slot;
  const Json* info = member(object, key);
  if (!info) return slot;
  const std::string where = path + "/" + key;
  const int texture = index_of(document, *info, "index", document.model.textures.size(), where);
  if (texture < 0) document.refuse(where, "the texture has no index (UNDEFINED_PROPERTY)");
  const int sampler = document.model.textures[size_t(texture)].sampler;
  if (sampler >= int(document.model.samplers.size()))
    document.refuse(fmt::format("/textures/{}/sampler", texture), "there is no sampler {} (UNRESOLVED_REFERENCE)",
                    sampler);
  slot.sampler = std::max(sampler, -1) + 1;
  slot.uv_set = std::max(index_of(document, *info, "texCoord", INT32_MAX, where), 0);
  apply_transform(document, *info, where, slot);
  const int image = image_of(document, texture, where);
  slot.image = image;
  if (image >= 0) image_used[size_t(image)] = true;
  return slot;
}

void import_images(Document& document, const std::vector<bool>& image_used, Scene& scene) {
  for (size_t i = 0; i < image_used.size(); ++i) {
    const Json& json = document.json["images"][i];
    const std::string path = fmt::format("/images/{}", i);
    SceneImage image;
    image.name = text(document, json, "name", "", path);
    image.place = document.place(named(path, json));
    if (image_used[i]) {
      if (json.contains("uri")) {
        auto read = read_named_file(document, text(document, json, "uri", "", path), path + "/uri");
        if (read)
          image.encoded = std::move(*read);
        else
          document.warn(named(path, json), "{}: {} (IO_ERROR)", read.error().text(), placeholder_note);
      } else {
        const int view = index_of(document, json, "bufferView", size_t(document.missing_view), path);
        if (view < 0) document.refuse(path, "the image has neither a uri nor a bufferView");
        const std::span<const std::byte> bytes = view_bytes(document, view, path + "/bufferView");
        document.charge(bytes.size(), 1, path);
        image.encoded.assign(bytes.begin(), bytes.end());
      }
    }
    scene.images.push_back(std::move(image));
  }
}

void check_transfer(Document& document, const Scene& scene) {
  std::set<int> told;
  const auto check = [&](int image, bool srgb, size_t material) {
    if (image < 0 || !is_ktx2(scene.images[size_t(image)].encoded)) return;
    const auto info = probe_ktx2(scene.images[size_t(image)].encoded, "");
    const Transfer other = srgb ? Transfer::linear : Transfer::srgb;
    if (!info || info->transfer != other || !told.insert(image).second) return;
    document.warn(named(fmt::format("/images/{}", image), document.json["images"][size_t(image)]),
                  "the file says that its numbers are {}, and is taken as {} where material {} uses it",
                  srgb ? "linear" : "sRGB", srgb ? "sRGB" : "linear", material);
  };
  for (size_t m = 0; m < scene.materials.size(); ++m)
    for_each_slot(scene.materials[m], [&](const TextureSlot& slot, bool srgb) {
      if (!slot) return;
      const SceneImage& image = scene.images[size_t(slot.image)];
      for (const int part : {slot.image, image.merge_occlusion, image.merge_metallic_roughness}) check(part, srgb, m);
    });
}

}  // namespace candela::gltf
