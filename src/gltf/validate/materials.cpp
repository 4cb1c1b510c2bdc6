#include <algorithm>

#include "gltf/validate/internal.h"

// Images, textures, samplers, materials, cameras and lights.
namespace candela::validation {
namespace {

std::string_view recognise_image(std::span<const std::byte> head) {
  const auto starts = [&](std::string_view magic, size_t at = 0) {
    return head.size() >= at + magic.size() && std::equal(magic.begin(), magic.end(), head.begin() + ptrdiff_t(at),
                                                          [](char a, std::byte b) { return std::byte(a) == b; });
  };
  if (starts("\x89PNG\r\n\x1A\n")) return "image/png";
  if (starts("\xFF\xD8\xFF")) return "image/jpeg";
  if (starts("RIFF") && starts("WEBP", 8)) return "image/webp";
  if (starts("\xABKTX 20\xBB\r\n\x1A\n")) return "image/ktx2";
  if (starts("DDS ")) return "image/vnd-ms.dds";
  return "";
}

struct ImageFormat {
  std::string_view declared, found;
  std::string_view known() const { return found.empty() ? declared : found; }
};

// Broken images are warnings: the loader leaves the texture out and says so.
ImageFormat check_image(Document& d, size_t i) {
  const Json& image = elements(d.json, "images")[i];
  const std::string path = fmt::format("/images/{}", i);
  ImageFormat format{text(image, "mimeType"), ""};
  const bool has_uri = image.contains("uri"), has_view = image.contains("bufferView");
  if (has_uri == has_view) {
    d.findings.fatal("ONE_OF_MISMATCH", path, "exactly one of 'uri' and 'bufferView' must be defined");
    return format;
  }
  std::vector<std::byte> head;
  const char* key = has_uri ? "/uri" : "/bufferView";
  if (has_uri) {
    const DataUri data = inspect_data_uri(text(image, "uri"));
    if (data.is_data && !data.valid)
      d.findings.fatal("INVALID_URI", path + "/uri", "the data URI is not well-formed base64");
    if (!data.is_data) return format;
    if (format.declared.empty()) format.declared = data.mime_type;
    head = data_uri_head(data, 16);
  } else {
    if (format.declared.empty())
      d.findings.warning("UNSATISFIED_DEPENDENCY", path + "/bufferView", "mimeType must be defined");
    const int64_t view_index = d.reference(image, "bufferView", "bufferViews", path);
    if (view_index < 0) return format;
    const Json& view = elements(d.json, "bufferViews")[view_index];
    if (view.contains("byteStride"))
      d.findings.warning("IMAGE_BUFFER_VIEW_WITH_BYTESTRIDE", path + "/bufferView",
                         "byteStride must not be defined for image data");
    const uint64_t offset = uint64_t(integer(view, "byteOffset", 0)), length = uint64_t(integer(view, "byteLength", 0));
    const bool in_chunk = d.parts.has_binary && integer(view, "buffer", 0) == 0 &&
                          !elements(d.json, "buffers")[0].contains("uri") && offset + length <= d.parts.binary.size();
    if (!in_chunk) return format;
    const auto bytes = d.parts.binary.subspan(offset, std::min<uint64_t>(length, 16));
    head.assign(bytes.begin(), bytes.end());
  }
  format.found = recognise_image(head);
  if (format.found.empty())
    d.findings.warning("IMAGE_UNRECOGNIZED_FORMAT", path + key, "image format not recognized");
  else if (!format.declared.empty() && format.declared != format.found)
    d.findings.warning("IMAGE_MIME_TYPE_INVALID", path + key, "the image is {}, declared as {}", format.found,
                       format.declared);
  return format;
}

struct TextureExtension {
  const char *name, *mime_type;
};
constexpr TextureExtension texture_extensions[] = {
    {"EXT_texture_webp", "image/webp"}, {"KHR_texture_basisu", "image/ktx2"}, {"MSFT_texture_dds", "image/vnd-ms.dds"}};

void check_texture(Document& d, size_t i, const std::vector<ImageFormat>& formats) {
  const Json& texture = elements(d.json, "textures")[i];
  const std::string path = fmt::format("/textures/{}", i);
  d.reference(texture, "sampler", "samplers", path);
  const int64_t source = d.reference(texture, "source", "images", path);
  if (source >= 0) {
    const std::string_view mime = formats[source].known();
    if (!mime.empty() && mime != "image/png" && mime != "image/jpeg")
      d.findings.warning("TEXTURE_INVALID_IMAGE_MIME_TYPE", path + "/source", "{} is not image/jpeg or image/png",
                         mime);
  }
  for (const auto& [name, wanted] : texture_extensions) {
    const Json& object = extension(texture, name);
    if (!object.is_object() || !is_whole(member(object, "source"))) continue;
    const std::string at = fmt::format("{}/extensions/{}", path, name);
    const int64_t image = d.reference(object, "source", "images", at);
    if (image >= 0 && !formats[image].known().empty() && formats[image].known() != wanted)
      d.findings.warning("TEXTURE_INVALID_IMAGE_MIME_TYPE", at + "/source", "{} is not {}", formats[image].known(),
                         wanted);
  }
}

// References of every texture slot, the ignored extensions' too: the loader lists who uses what.
void check_texture_slots(Document& d, const Json& object, const std::string& path) {
  for (const auto& [key, value] : object.items()) {
    if (!value.is_object() || key == "extras") continue;
    const std::string at = path + "/" + pointer_token(key);
    if (key.ends_with("Texture"))
      d.reference(value, "index", "textures", at);
    else if (key == "extensions" || key == "pbrMetallicRoughness" || key.starts_with("KHR_materials_"))
      check_texture_slots(d, value, at);
  }
}

void check_material(Document& d, size_t i) {
  const Json& material = elements(d.json, "materials")[i];
  const std::string path = fmt::format("/materials/{}", i);
  check_texture_slots(d, material, path);
  if (material.contains("alphaCutoff") && text(material, "alphaMode") != "MASK")
    d.findings.warning("MATERIAL_ALPHA_CUTOFF_INVALID_MODE", path + "/alphaCutoff",
                       "alphaCutoff has no effect without alphaMode MASK");
  const Json& emissive = member(material, "emissiveFactor");
  const bool dark =
      !emissive.is_array() || std::all_of(emissive.begin(), emissive.end(), [](const Json& v) { return v == 0; });
  if (extension(material, "KHR_materials_emissive_strength").is_object() && dark)
    d.findings.warning("KHR_MATERIALS_EMISSIVE_STRENGTH_ZERO_FACTOR",
                       path + "/extensions/KHR_materials_emissive_strength",
                       "emissive strength has no effect when the emissive factor is zero");
  const double ior = number(extension(material, "KHR_materials_ior"), "ior", 1.5);
  if (ior != 0 && ior < 1)
    d.findings.fatal("VALUE_NOT_IN_RANGE", path + "/extensions/KHR_materials_ior/ior",
                     "value {} is neither 0 nor at least 1", ior);
  const Json& coat = extension(material, "KHR_materials_clearcoat");
  if (integer(member(coat, "clearcoatNormalTexture"), "texCoord", 0) !=
          integer(member(material, "normalTexture"), "texCoord", 0) &&
      coat.contains("clearcoatNormalTexture") && material.contains("normalTexture"))
    d.findings.warning("KHR_MATERIALS_CLEARCOAT_CLEARCOAT_NORMAL_TEXTURE_TEXCOORD",
                       path + "/extensions/KHR_materials_clearcoat/clearcoatNormalTexture",
                       "normal and coat normal textures use different UV sets");
}

void check_camera(Document& d, size_t i) {
  const Json& camera = elements(d.json, "cameras")[i];
  const std::string path = fmt::format("/cameras/{}", i);
  const std::string type(text(camera, "type"));
  const Json& lens = member(camera, type);
  if (!lens.is_object()) return d.findings.fatal("UNDEFINED_PROPERTY", path, "property '{}' must be defined", type);
  if (camera.contains("perspective") && camera.contains("orthographic"))
    d.findings.warning("ONE_OF_MISMATCH", path, "a camera is either perspective or orthographic; {} is used", type);
  const std::string at = path + "/" + type;
  if (lens.contains("zfar") && number(lens, "zfar", 0) <= number(lens, "znear", 0))
    d.findings.fatal("CAMERA_ZFAR_LEQUAL_ZNEAR", at, "zfar must be greater than znear");
  if (type == "perspective" && number(lens, "yfov", 0) >= 3.14159265358979)
    d.findings.fatal("CAMERA_YFOV_GEQUAL_PI", at + "/yfov", "yfov must be less than pi");
  if (type == "orthographic")
    for (const char* key : {"xmag", "ymag"}) {
      if (number(lens, key, 1) == 0)
        d.findings.fatal("CAMERA_XMAG_YMAG_ZERO", at + "/" + key, "{} must not be zero", key);
      else if (number(lens, key, 1) < 0)
        d.findings.warning("CAMERA_XMAG_YMAG_NEGATIVE", at + "/" + key, "{} should not be negative", key);
    }
}

void check_light(Document& d, const Json& light, size_t i) {
  const std::string path = fmt::format("/extensions/KHR_lights_punctual/lights/{}", i);
  if (text(light, "type") == "directional" && extension(light, "CANDELA_light_size").is_object())
    d.findings.fatal("VALUE_NOT_IN_LIST", path + "/extensions/CANDELA_light_size",
                     "a directional light has no radius in metres; only point and spot lights do");
  if (text(light, "type") != "spot") return;
  const Json& spot = member(light, "spot");
  if (!spot.is_object()) return d.findings.fatal("UNDEFINED_PROPERTY", path, "property 'spot' must be defined");
  const double inner = number(spot, "innerConeAngle", 0), outer = number(spot, "outerConeAngle", 0.7853981633974483);
  if (outer <= inner)
    d.findings.warning("KHR_LIGHTS_PUNCTUAL_LIGHT_SPOT_ANGLES", path + "/spot/outerConeAngle",
                       "outerConeAngle ({}) is less than or equal to innerConeAngle ({})", outer, inner);
}

}  // namespace

void collect_texcoord_uses(const Json& object, const std::string& path, std::vector<TexcoordUse>& uses) {
  if (!object.is_object()) return;
  for (const auto& [key, value] : object.items()) {
    if (!value.is_object() || key == "extras") continue;
    const std::string at = path + "/" + pointer_token(key);
    if (key.ends_with("Texture")) {
      const Json& transform = extension(value, "KHR_texture_transform");
      if (is_whole(member(transform, "texCoord")))
        uses.push_back({at + "/extensions/KHR_texture_transform", integer(transform, "texCoord", 0)});
      else
        uses.push_back({at, integer(value, "texCoord", 0)});
    } else if (key == "extensions" || key == "pbrMetallicRoughness" || key.starts_with("KHR_materials_")) {
      collect_texcoord_uses(value, at, uses);
    }
  }
}

void check_textures(Document& d) {
  std::vector<ImageFormat> formats;
  for (size_t i = 0; i < d.count("images"); ++i) formats.push_back(check_image(d, i));
  for (const auto& [name, mime_type] : texture_extensions) {
    if (d.uses(name)) continue;
    for (size_t i = 0; i < formats.size(); ++i)
      if (formats[i].known() == mime_type)
        d.findings.warning("IMAGE_NON_ENABLED_MIME_TYPE", fmt::format("/images/{}", i), "{} needs the extension {}",
                           mime_type, name);
  }
  for (size_t i = 0; i < d.count("textures"); ++i) check_texture(d, i, formats);
}

void check_materials(Document& d) {
  for (size_t i = 0; i < d.count("materials"); ++i) check_material(d, i);
  for (size_t i = 0; i < d.count("cameras"); ++i) check_camera(d, i);
  const Json& lights = elements(extension(d.json, "KHR_lights_punctual"), "lights");
  for (size_t i = 0; i < lights.size(); ++i) check_light(d, lights[i], i);
}

}  // namespace candela::validation
