#include "scene/cut_outs.h"

#include <algorithm>
#include <map>

#include "scene/scene_images.h"

namespace candela {
namespace {

constexpr float near_enough = 1.0f / 255;
bool is_all_or_nothing(float alpha) { return alpha <= near_enough || alpha >= 1 - near_enough; }

bool texture_is_all_or_nothing(const Scene& scene, int image) {
  const auto texture = decode_scene_image(scene, image);
  if (!texture || !texture->warnings.empty()) return false;
  const DecodedImage& decoded = texture->image;
  const size_t values = size_t(decoded.width) * size_t(decoded.height) * 4;
  const auto all = [&]<class T>(const T*, double one) {
    const T* const value = reinterpret_cast<const T*>(decoded.pixels.data());
    for (size_t i = 3; i < values; i += 4)
      if (!is_all_or_nothing(float(double(value[i]) / one))) return false;
    return true;
  };
  if (decoded.format == DecodedImage::Format::rgba8) return all(static_cast<const uint8_t*>(nullptr), 255);
  if (decoded.format == DecodedImage::Format::rgba16) return all(static_cast<const uint16_t*>(nullptr), 65535);
  return all(static_cast<const float*>(nullptr), 1);
}

bool may_have_alpha(const Scene& scene, int image) {
  const SceneImage& stored = scene.images[size_t(image)];
  const auto info = probe_image(stored.encoded, stored.place);
  return !info || info->channels % 2 == 0;  // grey or colours, and alpha
}

// Takes the blended materials out that have a corner whose alpha is not accepted, or whose alpha an animation moves.
template <class Accepts>
std::vector<uint32_t> by_corners_and_animations(const Scene& scene, std::vector<bool> chosen, const Accepts& accepts) {
  for (const Mesh& mesh : scene.meshes)
    for (const MeshSection& section : mesh.sections)
      if (section.material >= 0 && chosen[size_t(section.material)])
        chosen[size_t(section.material)] =
            std::ranges::all_of(section.color, [&](const glm::vec4& c) { return accepts(c.w); });
  for (const Animation& animation : scene.animations)
    for (const AnimationChannel& channel : animation.channels)
      if (channel.path == TargetPath::material_base_color && (channel.element < 0 || channel.element == 3))
        chosen[size_t(channel.object)] = false;
  std::vector<uint32_t> all;
  for (size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i]) all.push_back(uint32_t(i));
  return all;
}

}  // namespace

std::vector<uint32_t> make_covering_opaque(Scene& scene) {
  std::vector<bool> covers(scene.materials.size());
  for (size_t i = 0; i < covers.size(); ++i) {
    const Material& m = scene.materials[i];
    const int image = m.base_color_texture.image;
    covers[i] = m.alpha_mode == AlphaMode::blend && m.base_color.w >= 1 && (image < 0 || !may_have_alpha(scene, image));
  }
  const auto covering = by_corners_and_animations(scene, std::move(covers), [](float alpha) { return alpha >= 1; });
  for (const uint32_t material : covering) scene.materials[material].alpha_mode = AlphaMode::opaque;
  return covering;
}

std::vector<uint32_t> cut_out_materials(const Scene& scene) {
  std::vector<bool> cut_out(scene.materials.size());
  std::map<int, bool> textures;
  for (size_t i = 0; i < cut_out.size(); ++i) {
    const Material& m = scene.materials[i];
    if (m.alpha_mode != AlphaMode::blend || m.base_color.w < 1 - near_enough) continue;
    const int image = m.base_color_texture.image;
    if (image < 0) continue;  // no shape of its own: a surface that its exporter might have called opaque
    const auto known = textures.find(image);
    cut_out[i] = known != textures.end()
                     ? known->second
                     : textures.emplace(image, texture_is_all_or_nothing(scene, image)).first->second;
  }
  return by_corners_and_animations(scene, std::move(cut_out), is_all_or_nothing);
}

const std::vector<std::string>& cut_out_choices() {
  static const std::vector<std::string> all = {"blended", "masked"};
  return all;
}

void apply_cut_outs(Scene& scene, const std::string& choice) {
  if (choice != "masked") return;
  for (const uint32_t material : cut_out_materials(scene)) {
    scene.materials[material].alpha_mode = AlphaMode::mask;
    scene.materials[material].alpha_cutoff = 0.5f;
  }
}

}  // namespace candela
