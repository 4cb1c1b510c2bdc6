#include "scene/survey.h"

#include "base/text.h"
#include "scene/draw_list.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace candela {
namespace {

// Counts stop at the top instead of starting over.
void add(uint32_t& count, uint64_t more) {
  count = uint32_t(std::min<uint64_t>(uint64_t(count) + more, std::numeric_limits<uint32_t>::max()));
}

bool emits(const Material& m) { return !m.unlit && m.emissive_strength > 0 && m.emissive != glm::vec3(0); }

bool has_transform(const TextureSlot& slot) {
  return slot.offset != glm::vec2(0) || slot.scale != glm::vec2(1) || slot.rotation_rad != 0;
}

void use_texture(SceneFacts& facts, const TextureSlot& slot, bool& any) {
  if (!slot) return;
  any = true;
  facts.image_used[size_t(slot.image)] = true;
  if (slot.uv_set == 1) facts.any_uv1 = true;
  if (has_transform(slot)) facts.any_texture_transform = true;
}

void use_lobe(SceneFacts& facts, const Material& m, Lobe lobe, std::initializer_list<TextureSlot> slots) {
  if (!m.has(lobe)) return;
  facts.lobes |= 1u << uint32_t(lobe);
  bool any = false;
  for (const TextureSlot& slot : slots) use_texture(facts, slot, any);
  if (any) facts.lobe_textures |= 1u << uint32_t(lobe);
}

// An unlit material shows its base colour alone, so nothing else of it counts.
void use_material(SceneFacts& facts, const Material& m, bool refraction) {
  use_texture(facts, m.base_color_texture, facts.any_base_texture);
  if (m.has_relief()) use_texture(facts, m.relief.texture, facts.any_relief);
  if (m.unlit) return;
  use_texture(facts, m.orm_texture, facts.any_orm_texture);
  use_texture(facts, m.occlusion_texture, facts.any_occlusion_texture);
  use_texture(facts, m.normal_texture, facts.any_normal_texture);
  use_texture(facts, m.specular_texture, facts.any_specular_texture);
  use_texture(facts, m.specular_color_texture, facts.any_specular_texture);
  facts.any_blinn_phong |= m.blinn_phong.shades;
  // Of a texture only the factor is known.
  facts.any_smooth |= m.roughness < smooth_roughness;
  if (m.ior != 1.5f || m.specular != 1 || m.specular_color != glm::vec3(1) || m.specular_texture ||
      m.specular_color_texture)
    facts.any_specular = true;
  const Clearcoat& coat = m.clearcoat;
  use_lobe(facts, m, Lobe::clearcoat, {coat.texture, coat.roughness_texture, coat.normal_texture});
  use_lobe(facts, m, Lobe::sheen, {m.sheen.color_texture, m.sheen.roughness_texture});
  use_lobe(facts, m, Lobe::iridescence, {m.iridescence.texture, m.iridescence.thickness_texture});
  use_lobe(facts, m, Lobe::anisotropy, {m.anisotropy.texture});
  const TextureSlot none;
  use_lobe(facts, m, Lobe::transmission,
           {refraction ? m.transmission_texture : none, refraction && m.thickness_m > 0 ? m.thickness_texture : none});
  use_lobe(facts, m, Lobe::diffuse_transmission,
           {m.diffuse_transmission.texture, m.diffuse_transmission.color_texture});
  use_lobe(facts, m, Lobe::scattering, {m.thickness_texture});
  if (!emits(m)) return;
  facts.emissive = true;
  use_texture(facts, m.emissive_texture, facts.any_emissive_texture);
}

// times: as often as it is drawn.
void count_item(SceneFacts& facts, const DrawItem& item, uint64_t times, const MeshSection& section,
                const Material& material, const FrameData& frame, bool refraction) {
  add(facts.draw_items, times);
  const bool unlit = is_unlit(section, &material);
  const bool blend = material.alpha_mode == AlphaMode::blend;
  if (refraction && refracts(section, material)) {
    add(facts.refracting_items, times);
    if (material.thickness_m > 0) add(facts.refracting_bodies, times);
  } else if (blend) {
    add(facts.blend_items, times);
    add(unlit ? facts.blend_unlit_items : facts.blend_lit_items, times);
  } else {
    add(material.alpha_mode == AlphaMode::mask ? facts.mask_items : facts.opaque_items, times);
    add(unlit ? facts.unlit_items : facts.lit_items, times);
  }
  if (section.metaballs >= 0) add(facts.metaball_chunks, times);
  if (item.deformed >= 0 && section.metaballs < 0) {
    const Deformation& deformation = frame.deformations[size_t(item.deformed)];
    add(facts.deformed_items, times);
    if (deformation.joint_count > 0) add(facts.skinned_items, times);
    if (deformation.weight_count > 0) add(facts.morphed_items, times);
  }
  switch (section.topology) {
    case Topology::triangles:
      add(facts.triangles, times * (section.index.size() / 3));
      break;
    case Topology::lines:
      add(facts.lines, times * (section.index.size() / 2));
      break;
    case Topology::points:
      add(facts.points, times * section.index.size());
      break;
  }
  if (!section.color.empty()) facts.any_vertex_color = true;
}

void count_lights(SceneFacts& facts, const FrameData& frame) {
  const auto count = [&](const LightItem& light, uint32_t times) {
    if (light.radius_m > 0) add(facts.sized_lights, times);
    switch (light.type) {
      case LightType::point:
        add(facts.point_lights, times);
        break;
      case LightType::spot:
        add(facts.spot_lights, times);
        break;
      case LightType::directional:
        add(facts.directional_lights, times);
        break;
    }
  };
  for (const LightItem& light : frame.lights) count(light, 1);
  for (const LightGroup& group : frame.light_groups) count(group.light, group.set->count);
}

nlohmann::ordered_json names_of_lobes(uint32_t lobes) {
  static constexpr const char* names[lobe_count] = {
      "clearcoat", "sheen", "iridescence", "anisotropy", "transmission", "diffuse_transmission", "scattering"};
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (uint32_t i = 0; i < lobe_count; ++i)
    if ((lobes >> i & 1) != 0) list.push_back(names[i]);
  return list;
}

nlohmann::ordered_json indices(const std::vector<bool>& used) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (size_t i = 0; i < used.size(); ++i)
    if (used[i]) list.push_back(i);
  return list;
}

}  // namespace

SceneFacts survey(const Scene& scene, const Pose& pose, const FrameData& frame, bool environment, bool refraction) {
  SceneFacts facts;
  facts.environment = environment;
  facts.perspective = frame.perspective;
  facts.material_used.assign(pose.materials.size(), false);
  facts.image_used.assign(scene.images.size(), false);
  const auto alike = [](const DrawItem& a, const DrawItem& b) {
    return a.mesh == b.mesh && a.section == b.section && a.material == b.material && a.deformed == b.deformed;
  };
  const auto look_at = [&](const DrawItem& item, uint64_t times) {
    const MeshSection& section = scene.meshes[item.mesh].sections[item.section];
    const bool has_material = item.material >= 0;
    const Material& material = has_material ? pose.materials[size_t(item.material)] : scene.default_material;
    count_item(facts, item, times, section, material, frame, refraction);
    if (has_material && !facts.material_used[size_t(item.material)]) {
      facts.material_used[size_t(item.material)] = true;
      use_material(facts, material, refraction);
    }
    if (!has_material) use_material(facts, material, refraction);
  };
  for (size_t i = 0, end = 0; i < frame.items.size(); i = end) {
    while (end < frame.items.size() && alike(frame.items[i], frame.items[end])) ++end;
    look_at(frame.items[i], end - i);
  }
  for (const ItemGroup& group : frame.item_groups)
    for (const uint32_t section : group.set->sections) {
      DrawItem item{.mesh = group.mesh, .section = section, .node = group.node};
      item.material = scene.meshes[group.mesh].sections[section].material;
      look_at(item, group.set->count);
    }
  for (const Deformation& deformation : frame.deformations)
    add(facts.deformed_vertices, scene.meshes[deformation.mesh].sections[deformation.section].position.size());
  count_lights(facts, frame);
  return facts;
}

std::string facts_json(const SceneFacts& f) {
  const nlohmann::ordered_json json = {
      {"draw_items", f.draw_items},
      {"opaque_items", f.opaque_items},
      {"mask_items", f.mask_items},
      {"blend_items", f.blend_items},
      {"lit_items", f.lit_items},
      {"unlit_items", f.unlit_items},
      {"blend_lit_items", f.blend_lit_items},
      {"blend_unlit_items", f.blend_unlit_items},
      {"refracting_items", f.refracting_items},
      {"refracting_bodies", f.refracting_bodies},
      {"deformed_items", f.deformed_items},
      {"skinned_items", f.skinned_items},
      {"morphed_items", f.morphed_items},
      {"deformed_vertices", f.deformed_vertices},
      {"metaball_chunks", f.metaball_chunks},
      {"triangles", f.triangles},
      {"lines", f.lines},
      {"points", f.points},
      {"point_lights", f.point_lights},
      {"spot_lights", f.spot_lights},
      {"directional_lights", f.directional_lights},
      {"sized_lights", f.sized_lights},
      {"emissive", f.emissive},
      {"environment", f.environment},
      {"perspective", f.perspective},
      {"any_normal_texture", f.any_normal_texture},
      {"any_base_texture", f.any_base_texture},
      {"any_orm_texture", f.any_orm_texture},
      {"any_occlusion_texture", f.any_occlusion_texture},
      {"any_emissive_texture", f.any_emissive_texture},
      {"any_specular_texture", f.any_specular_texture},
      {"any_vertex_color", f.any_vertex_color},
      {"any_uv1", f.any_uv1},
      {"any_texture_transform", f.any_texture_transform},
      {"any_specular", f.any_specular},
      {"any_blinn_phong", f.any_blinn_phong},
      {"any_relief", f.any_relief},
      {"lobes", names_of_lobes(f.lobes)},
      {"lobes_with_textures", names_of_lobes(f.lobe_textures)},
      {"materials_used", indices(f.material_used)},
      {"images_used", indices(f.image_used)},
      {"cut_out_materials", f.cut_outs},
  };
  return json.dump(2);
}

}  // namespace candela
