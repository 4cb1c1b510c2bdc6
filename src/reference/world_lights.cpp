// Lights of a World: punctual ones, emissive triangles, and the tree that chooses among them.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "reference/world.h"
#include "scene/scene_size.h"

namespace candela::reference {
namespace {

using std::numbers::pi;

LightExtent extent_of(const PunctualLight& light) {
  LightExtent e;
  e.box.add(light.position - light.radius_m);
  e.box.add(light.position + light.radius_m);
  e.is_sphere = light.radius_m > 0;
  e.range_m = light.range_m;
  e.axis = light.direction;
  // Candela times pi, to be of the same kind as a triangle's radiance times area times pi.
  e.power = luminance(light.intensity) * pi;
  e.theta_o = pi;
  if (light.type == LightType::spot) {
    e.theta_o = 0;
    e.theta_e = std::acos(std::clamp(light.cos_outer, -1.0, 1.0));
  }
  return e;
}

}  // namespace

void World::add_lights() {
  std::vector<LightExtent> extents;
  const double least_light_m = least_light_distance_m(input_.scene);
  for (const LightItem& item : input_.frame.lights) {
    const uint32_t index = uint32_t(punctual_.size());
    punctual_.push_back(punctual_light(item, least_light_m));
    punctual_.back().group = index < input_.light_group_of.size() ? input_.light_group_of[index] : input_.other_lights;
    has_sized_lights_ |= punctual_.back().has_size();
    if (item.type == LightType::directional) {
      directional_.push_back(index);
      continue;
    }
    tree_punctual_.push_back(index);
    extents.push_back(extent_of(punctual_.back()));
  }
  for (const LightExtent& e : extents) lamp_power_.push_back((lamp_power_.empty() ? 0 : lamp_power_.back()) + e.power);
  lamp_tree_ = LightTree(extents);
  add_emissive_triangles(extents);
  add_glowing_bodies(extents);
  tree_ = LightTree(std::move(extents));
  add_bending_walls();
}

void World::add_bending_walls() {
  const auto is_point = [](const PunctualLight& light) { return !light.has_size(); };
  if (!has_glass_ || std::none_of(punctual_.begin(), punctual_.end(), is_point)) return;
  bool bends = false;
  double area_m2 = 0;
  for (uint32_t i = 0; i < items_.size(); ++i) {
    const TracedMaterial& t = *items_[i].material;
    const bool textured = t.orm && t.material.orm_has_metallic_roughness;
    if (items_[i].section->metaballs >= 0) continue;  // no triangles to choose places on
    if (!bounds_body(i) || !(t.material.transmission > 0) || items_[i].section->topology != Topology::triangles)
      continue;
    if (t.material.roughness >= least_roughness && !textured) continue;
    bends |= t.glass->ior != 1 && t.glass->ior != 0;
    for (uint32_t k = 0; k < items_[i].section->index.size() / 3; ++k) {
      const PosedTriangle posed = accel_.triangle(i, k);
      const glm::dvec3 p0(posed.position[0]);
      const double area =
          glm::length(glm::cross(glm::dvec3(posed.position[1]) - p0, glm::dvec3(posed.position[2]) - p0)) / 2;
      if (area > 0 && std::isfinite(area)) bending_.push_back({i, k, area_m2 += area});
    }
  }
  if (!bends) bending_.clear();
}

glm::dvec3 World::bending_place(double which, glm::dvec2 u) const {
  const double at = which * bending_.back().area_to_m2;
  const auto wall = std::lower_bound(bending_.begin(), bending_.end() - 1, at,
                                     [](const Wall& w, double area) { return w.area_to_m2 < area; });
  const PosedTriangle posed = accel_.triangle(wall->item, wall->primitive);
  const double root = std::sqrt(u.x);
  const glm::dvec3 weight(1 - root, root * (1 - u.y), root * u.y);
  return weight.x * glm::dvec3(posed.position[0]) + weight.y * glm::dvec3(posed.position[1]) +
         weight.z * glm::dvec3(posed.position[2]);
}

uint32_t World::lamp_by_power(double u) const {
  return uint32_t(std::upper_bound(lamp_power_.begin(), lamp_power_.end() - 1, u * lamp_power_.back()) -
                  lamp_power_.begin());
}

double World::lamp_power_share(uint32_t lamp) const {
  const double own = lamp_power_[lamp] - (lamp > 0 ? lamp_power_[lamp - 1] : 0);
  return lamp_power_.back() > 0 ? own / lamp_power_.back() : 0;
}

void World::add_emissive_triangles(std::vector<LightExtent>& extents) {
  emissive_index_.resize(items_.size());
  for (uint32_t i = 0; i < items_.size(); ++i) {
    const TracedItem& item = items_[i];
    const Material& m = item.material->material;
    if (item.section->metaballs >= 0) continue;
    if (item.section->topology != Topology::triangles || item.unlit || m.emissive * m.emissive_strength == glm::vec3(0))
      continue;
    if (item.material->heights) continue;  // its light does not come from its triangles: paths meet it by chance
    const uint32_t count = uint32_t(item.section->index.size() / 3);
    emissive_index_[i].assign(count, -1);
    for (uint32_t k = 0; k < count; ++k) {
      const PosedTriangle posed = accel_.triangle(i, k);
      EmissiveTriangle t;
      t.item = i, t.primitive = k, t.two_sided = m.double_sided;
      for (int c = 0; c < 3; ++c) t.corner[c] = posed.position[size_t(c)];
      const glm::dvec3 n = glm::cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
      const double twice_area = glm::length(n);
      if (!(twice_area > 0) || !std::isfinite(twice_area)) continue;
      t.area_m2 = twice_area / 2;
      t.normal = (input_.frame.items[i].mirrored ? -n : n) / twice_area;
      // Mean over the triangle. Where the estimate sees no light there may still be some: paths that meet it by chance
      // count it.
      double mean = 0;
      constexpr int rows = 4;
      for (int a = 0; a < rows; ++a)
        for (int b = 0; a + b < rows; ++b) {
          const double u = (a + 1.0 / 3) / rows, v = (b + 1.0 / 3) / rows;
          const Vertex vertex = vertex_at(item, posed.vertex, {1 - u - v, u, v});
          mean += luminance(emission_at(*item.material, vertex)) * coverage_of(m, base_color(*item.material, vertex).w);
        }
      mean /= rows * (rows + 1) / 2;
      if (!(mean > 0)) continue;
      LightExtent e;
      for (const glm::dvec3& c : t.corner) e.box.add(c);
      e.axis = t.normal;
      e.power = mean * t.area_m2 * (t.two_sided ? 2 : 1) * pi;
      e.theta_o = t.two_sided ? pi : 0;
      e.theta_e = pi / 2;
      extents.push_back(e);
      emissive_index_[i][k] = int(emissive_.size());
      emissive_.push_back(t);
    }
  }
}

void World::add_glowing_bodies(std::vector<LightExtent>& extents) {
  for (uint32_t i = 0; i < items_.size(); ++i) {
    const TracedItem& item = items_[i];
    const MetaballSurface* surface = accel_.implicit(i);
    if (!surface || item.unlit) continue;
    const Material& m = item.material->material;
    const double light =
        luminance(emission_at(*item.material, Vertex{})) * coverage_of(m, base_color(*item.material, Vertex{}).w);
    GlowingBody body(i, *surface, m.double_sided);
    if (!(light > 0) || body.spheres().empty()) continue;
    LightExtent e;
    double area_m2 = 0;
    for (const glm::dvec4& s : body.spheres()) {
      e.box.add(glm::dvec3(s) - s.w), e.box.add(glm::dvec3(s) + s.w);
      area_m2 += 4 * pi * s.w * s.w;
    }
    e.power = light * area_m2 * (body.two_sided() ? 2 : 1) * pi;
    e.theta_o = pi, e.theta_e = pi / 2;
    extents.push_back(e);
    emissive_index_[i] = {int(emissive_.size() + glowing_.size())};
    glowing_.push_back(std::move(body));
  }
}

}  // namespace candela::reference
