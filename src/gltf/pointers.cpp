#include "gltf/pointers.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "scene/material_table.h"

namespace candela::gltf {
namespace {

using enum TargetPath;

std::optional<size_t> number_in(std::string_view text) {
  size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// Splits "/materials/3/rest" into the index and "rest" when it begins with `array`.
struct Indexed {
  size_t index;
  std::string_view rest;
};
std::optional<Indexed> in_array(std::string_view pointer, std::string_view array) {
  if (!pointer.starts_with(array)) return std::nullopt;
  pointer.remove_prefix(array.size());
  const size_t slash = pointer.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const std::optional<size_t> index = number_in(pointer.substr(0, slash));
  return index ? std::optional(Indexed{*index, pointer.substr(slash + 1)}) : std::nullopt;
}

struct Property {
  std::string_view pointer;
  TargetPath path;
  int components;
};

constexpr Property node_properties[] = {
    {"translation", node_translation, 3},
    {"rotation", node_rotation, 4},
    {"scale", node_scale, 3},
    {"extensions/KHR_node_visibility/visible", node_visible, 1},
};
constexpr Property light_properties[] = {
    {"color", light_color, 3},
    {"intensity", light_intensity, 1},
    {"range", light_range, 1},
    {"spot/innerConeAngle", light_inner_cone, 1},
    {"spot/outerConeAngle", light_outer_cone, 1},
};
constexpr Property perspective_properties[] = {
    {"perspective/yfov", camera_yfov, 1},
    {"perspective/aspectRatio", camera_aspect, 1},
    {"perspective/znear", camera_near, 1},
    {"perspective/zfar", camera_far, 1},
};
constexpr Property orthographic_properties[] = {
    {"orthographic/xmag", camera_xmag, 1},
    {"orthographic/ymag", camera_ymag, 1},
    {"orthographic/znear", camera_near, 1},
    {"orthographic/zfar", camera_far, 1},
};
constexpr Property transform_properties[] = {
    {"offset", texture_offset, 2},
    {"rotation", texture_rotation, 1},
    {"scale", texture_scale, 2},
};

// Of materials, as drafts of extensions call what they have.
constexpr Property draft_properties[] = {
    {"extensions/KHR_materials_volume_scatter/multiscatterColor", material_multiscatter_color, 3},
};

// The property itself or, with a further index, one component of it.
std::optional<PointerTarget> found_in(std::span<const Property> properties, std::string_view rest, size_t object) {
  for (const Property& p : properties) {
    if (rest == p.pointer) return PointerTarget{p.path, int(object), -1, p.components};
    if (p.components < 2 || p.path == node_rotation || !rest.starts_with(p.pointer) ||
        rest.size() < p.pointer.size() + 2 || rest[p.pointer.size()] != '/')
      continue;
    const std::optional<size_t> component = number_in(rest.substr(p.pointer.size() + 1));
    if (component && *component < size_t(p.components)) return PointerTarget{p.path, int(object), int(*component), 1};
  }
  return std::nullopt;
}

// Which slot of the imported material a texture of the file went to: occlusion may have been joined with
// metallic-roughness.
std::optional<TextureSlotName> slot_named(const Material& material, std::string_view texture) {
  if (texture == "occlusionTexture" && !material.occlusion_texture) return TextureSlotName::orm;
  for (const MaterialTexture& t : material_textures())
    if (texture == t.pointer) return t.slot;
  return std::nullopt;
}

std::optional<PointerTarget> texture_target(const Material& material, std::string_view rest, size_t object) {
  constexpr std::string_view middle = "/extensions/KHR_texture_transform/";
  const size_t at = rest.find(middle);
  if (at == std::string_view::npos) return std::nullopt;
  const std::optional<TextureSlotName> slot = slot_named(material, rest.substr(0, at));
  std::optional<PointerTarget> target;
  for (const Property& p : transform_properties)
    if (rest.substr(at + middle.size()) == p.pointer && slot)
      target = PointerTarget{p.path, int(object), int(*slot), p.components};
  return target;
}

// Of CANDELA_metaballs: what all share, or of one ball.
std::optional<PointerTarget> metaballs_target(const Scene& scene, size_t node, std::string_view rest) {
  const auto body = std::ranges::find(scene.metaballs, int(node), &Metaballs::node);
  if (body == scene.metaballs.end()) return std::nullopt;
  const int number = int(body - scene.metaballs.begin());
  if (rest == "threshold") return PointerTarget{metaballs_threshold, number, -1, 1};
  const auto ball = in_array(rest, "balls/");
  if (!ball || ball->index >= body->balls.size()) return std::nullopt;
  if (ball->rest == "radius") return PointerTarget{metaballs_radius, number, int(ball->index), 1};
  if (ball->rest == "strength") return PointerTarget{metaballs_strength, number, int(ball->index), 1};
  return std::nullopt;
}

std::optional<PointerTarget> node_target(const Scene& scene, const Indexed& node) {
  if (node.index >= scene.nodes.size()) return std::nullopt;
  constexpr std::string_view metaballs = "extensions/CANDELA_metaballs/";
  if (node.rest.starts_with(metaballs)) return metaballs_target(scene, node.index, node.rest.substr(metaballs.size()));
  if (!node.rest.starts_with("weights")) return found_in(node_properties, node.rest, node.index);
  const int mesh = scene.nodes[node.index].mesh;
  const size_t targets = mesh < 0 ? 0 : scene.meshes[size_t(mesh)].default_weights.size();
  if (targets == 0) return std::nullopt;
  if (node.rest == "weights") return PointerTarget{node_weights, int(node.index), -1, int(targets)};
  const std::optional<size_t> one = node.rest.starts_with("weights/") ? number_in(node.rest.substr(8)) : std::nullopt;
  return one && *one < targets ? std::optional(PointerTarget{node_weights, int(node.index), int(*one), 1})
                               : std::nullopt;
}

}  // namespace

std::optional<PointerTarget> pointer_target(const Scene& scene, std::string_view pointer) {
  if (const auto node = in_array(pointer, "/nodes/")) return node_target(scene, *node);
  if (const auto material = in_array(pointer, "/materials/")) {
    if (material->index >= scene.materials.size()) return std::nullopt;
    for (const MaterialProperty& p : material_properties())
      if (const auto target =
              found_in(std::array{Property{p.pointer, p.path, p.components}}, material->rest, material->index))
        return target;
    if (const auto target = found_in(draft_properties, material->rest, material->index)) return target;
    return texture_target(scene.materials[material->index], material->rest, material->index);
  }
  if (const auto light = in_array(pointer, "/extensions/KHR_lights_punctual/lights/"))
    return light->index < scene.lights.size() ? found_in(light_properties, light->rest, light->index) : std::nullopt;
  if (const auto camera = in_array(pointer, "/cameras/"); camera && camera->index < scene.cameras.size()) {
    if (scene.cameras[camera->index].perspective) return found_in(perspective_properties, camera->rest, camera->index);
    return found_in(orthographic_properties, camera->rest, camera->index);
  }
  return std::nullopt;
}

}  // namespace candela::gltf
