#include "reference/world.h"

#include "scene/geometry_layout.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numbers>

#include "reference/scattering.h"
#include "scene/draw_list.h"
#include "scene/glow.h"
#include "scene/scene_images.h"
#include "scene/texture_slots.h"

namespace candela::reference {
namespace {

// By cofactors: the inverse transpose times the determinant's size, finite for singular matrices too.
glm::dmat3 normal_matrix(const glm::dmat3& m) {
  const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return glm::determinant(m) < 0 ? -cofactors : cofactors;
}

// Light goes on behind any surface of glass, so that the filter must be asked about all of them: it knows which are
// passed.
AccelOptions accel_options(const WorldInput& input) {
  AccelOptions options = input.accel;
  options.always_ask_filter |= input.glass && has_transmission(input.scene);
  options.open_sides |= input.open_sides;
  options.implicit = true;
  return options;
}

}  // namespace

World::World(const WorldInput& input, std::vector<std::string>& warnings)
    : input_(input), accel_(input.scene, input.pose, input.frame, accel_options(input)) {
  if (input.fog) media_.emplace_back(*input.fog, input.view.position);
  for (const Fog& fog : input.more_fog) media_.emplace_back(fog, input.view.position);
  load_materials(warnings);
  add_items();
  add_lights();
}

void World::add_textures(const Material& material) {
  const auto add = [&](const TextureSlot& slot, bool srgb) {
    if (slot) textures_[{slot.image, srgb}] = nullptr;
  };
  for_each_shown_slot(material, add);
}

void World::load_materials(std::vector<std::string>& warnings) {
  // Only what drawn items use is decoded.
  std::vector<bool> used(input_.pose.materials.size());
  for (const DrawItem& item : input_.frame.items)
    if (item.material >= 0) used[size_t(item.material)] = true;
  for (size_t m = 0; m < used.size(); ++m)
    if (used[m]) add_textures(input_.pose.materials[m]);
  std::vector<std::pair<const std::pair<int, bool>, std::unique_ptr<Texture>>*> list;
  for (auto& entry : textures_) list.push_back(&entry);
  std::vector<std::vector<std::string>> damaged(list.size());
  tbb::parallel_for(size_t(0), list.size(), [&](size_t i) {
    auto texture = decode_scene_image(input_.scene, list[i]->first.first);
    if (!texture) throw std::bad_alloc();
    list[i]->second = std::make_unique<Texture>(std::move(texture->image), list[i]->first.second);
    damaged[i] = std::move(texture->warnings);
  });
  for (const std::vector<std::string>& texts : damaged) warnings.insert(warnings.end(), texts.begin(), texts.end());

  const auto find = [&](const TextureSlot& slot, bool srgb) -> const Texture* {
    const auto found = slot ? textures_.find({slot.image, srgb}) : textures_.end();
    return found == textures_.end() ? nullptr : found->second.get();
  };
  std::vector<Material> materials = input_.pose.materials;
  materials.push_back(input_.scene.default_material);
  for (const Material& m : materials) {
    TracedMaterial t{m};
    t.base = find(m.base_color_texture, true);
    t.orm = find(m.orm_texture, false);
    t.occlusion = find(m.occlusion_texture, false);
    t.normal = find(m.normal_texture, false);
    t.emissive = find(m.emissive_texture, true);
    t.specular = find(m.specular_texture, false);
    t.specular_color = find(m.specular_color_texture, true);
    if (m.has_relief()) t.heights = find(m.relief.texture, false);
    if (m.has(Lobe::clearcoat)) {
      t.clearcoat = find(m.clearcoat.texture, false);
      t.clearcoat_roughness = find(m.clearcoat.roughness_texture, false);
      t.clearcoat_normal = find(m.clearcoat.normal_texture, false);
    }
    if (m.has(Lobe::sheen)) {
      t.sheen_color = find(m.sheen.color_texture, true);
      t.sheen_roughness = find(m.sheen.roughness_texture, false);
    }
    if (m.has(Lobe::iridescence)) {
      t.iridescence = find(m.iridescence.texture, false);
      t.film_thickness = find(m.iridescence.thickness_texture, false);
    }
    if (m.has(Lobe::anisotropy)) t.anisotropy = find(m.anisotropy.texture, false);
    if (m.has(Lobe::diffuse_transmission)) {
      t.diffuse_transmission = find(m.diffuse_transmission.texture, false);
      t.transmitted_color = find(m.diffuse_transmission.color_texture, true);
    }
    if (input_.glass && (m.has(Lobe::transmission) || m.has(Lobe::scattering))) {
      t.transmission = find(m.transmission_texture, false);
      // Light that comes in diffusely alone is not bent.
      const double ior = m.has(Lobe::transmission) ? m.ior : 0;
      t.glass = Glass{ior, m.dispersion, m.thickness_m > 0, m.attenuation_color, m.attenuation_distance_m};
      if (m.has(Lobe::scattering)) t.glass->medium = body_medium(m);
    }
    if (!input_.glass && m.has(Lobe::scattering)) {
      t.slab = body_medium(m);
      t.thickness = find(m.thickness_texture, false);
    }
    materials_.push_back(std::move(t));
  }
}

void World::add_items() {
  for (const DrawItem& item : input_.frame.items) {
    TracedItem t;
    t.section = &input_.scene.meshes[item.mesh].sections[item.section];
    if (item.deformed >= 0) t.deformed = &accel_.deformed(item.deformed);
    t.material = item.material >= 0 ? &materials_[size_t(item.material)] : &materials_.back();
    t.relative_from_local = glm::dmat4(input_.frame.relative_from_local[item.transform]);
    const glm::dmat3 linear(t.relative_from_local);
    t.normal_from_local = normal_matrix(linear);
    t.mirrored = glm::determinant(linear) < 0 ? -1 : 1;
    t.unlit = is_unlit(*t.section, item.material >= 0 ? &t.material->material : nullptr);
    if (t.section->topology == Topology::triangles) {
      has_blend_ |= t.material->material.alpha_mode == AlphaMode::blend;
      has_glass_ |= t.material->glass.has_value();
      if (t.material->heights) add_relief_bounds(t);
      TracedMaterial& traced = item.material >= 0 ? materials_[size_t(item.material)] : materials_.back();
      if (traced.glass && traced.glass->medium) thin_out(*traced.glass->medium, t);
    }
    items_.push_back(t);
  }
}

void World::add_relief_bounds(TracedItem& item) {
  has_relief_ = true;
  const bool second = item.material->material.relief.texture.uv_set == 1;
  const UvBounds bounds = uv_bounds(second ? item.section->uv1 : item.section->uv0);
  item.least_uv = bounds.least, item.most_uv = bounds.most;
}

// Ways between events must be longer than what floats tell apart where the item lies: a denser medium is thinned out,
// which keeps what it reflects.
void World::thin_out(BodyMedium& medium, const TracedItem& item) {
  const Aabb& bounds = item.section->bounds;
  const DAabb box = transformed({glm::dvec3(bounds.min), glm::dvec3(bounds.max)}, item.relative_from_local);
  const double far_m = largest(glm::max(glm::abs(box.min), glm::abs(box.max)));
  for (int c = 0; c < 3; ++c) {
    const double kept = medium.extinction[c] * far_m > 1e5 ? 1e5 / (medium.extinction[c] * far_m) : 1;
    medium.extinction[c] *= kept, medium.scattering[c] *= kept;
  }
}

CameraRay World::camera_ray(glm::dvec2 pixel, int width_px, int height_px) const {
  const View& view = input_.view;
  const glm::dmat3 axes = glm::transpose(glm::dmat3(view.view_from_relative));  // right, up, back
  const double x = (2 * pixel.x / width_px - 1) * view.tan_x, y = (2 * pixel.y / height_px - 1) * view.tan_y;
  const glm::dvec3 across = x * axes[0] - y * axes[1];
  CameraRay ray;
  ray.direction = -axes[2];
  (view.perspective ? ray.direction : ray.origin) += across;
  ray.t_min = view.near_m;
  if (!view.perspective) ray.t_max = view.far_m;
  return ray;
}

CameraRay World::through_lens(CameraRay ray, glm::dvec2 u) const {
  const glm::dmat3 axes = glm::transpose(glm::dmat3(input_.view.view_from_relative));
  const double radius_m = input_.lens_radius_m * std::sqrt(u.x), angle = 2 * std::numbers::pi * u.y;
  const glm::dvec3 point = radius_m * (std::cos(angle) * axes[0] + std::sin(angle) * axes[1]);
  ray.origin += point;
  ray.direction -= point / input_.focus_m;
  return ray;
}

RayDifferential World::camera_steps(int width_px, int height_px) const {
  const CameraRay first = camera_ray({0, 0}, width_px, height_px);
  RayDifferential steps;
  for (int i = 0; i < 2; ++i) {
    const CameraRay next = camera_ray({i == 0, i == 1}, width_px, height_px);
    steps.place[i] = next.origin - first.origin, steps.direction[i] = next.direction - first.direction;
  }
  return steps;
}

glm::dvec4 World::background(glm::dvec3 direction) const {
  if (!input_.sky_visible) return input_.background;
  const glm::dvec3 d = glm::normalize(direction);
  return {input_.sky_blur_rad > 0 ? input_.sky.blurred(d, input_.sky_blur_rad) : input_.sky.seen(d), 1};
}

bool World::is_masked(uint32_t item) const { return items_[item].material->material.alpha_mode == AlphaMode::mask; }
bool World::is_blended(uint32_t item) const { return items_[item].material->material.alpha_mode == AlphaMode::blend; }
bool World::glows_all_over(uint32_t item) const { return candela::glows_all_over(items_[item].material->material); }
bool World::is_double_sided(uint32_t item) const { return items_[item].material->material.double_sided; }

bool World::bounds_body(uint32_t item) const {
  return items_[item].material->glass && items_[item].material->glass->body;
}

int World::emissive_of(uint32_t item, uint32_t primitive) const {
  const std::vector<int>& index = emissive_index_[item];
  return index.empty() ? -1 : index[primitive];
}

}  // namespace candela::reference
