// What the material says of a point (glTF 2.0, 3.9 and appendix B), from the vertices and textures in double.
#include <cmath>

#include "reference/albedo.h"
#include "reference/metaballs.h"
#include "reference/scattering.h"
#include "reference/world.h"
#include "scene/blinn_phong.h"

namespace candela::reference {
namespace {

glm::dvec3 unit_or_zero(glm::dvec3 v) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0);
}

// The weights of the corners where the ray's line meets the triangle's plane; the hit's own where it runs along the
// plane.
glm::dvec2 barycentrics_of(const std::array<glm::vec3, 3>& corner, const Hit& hit, glm::dvec3 origin,
                           glm::dvec3 direction) {
  const glm::dvec3 p0(corner[0]), e1 = glm::dvec3(corner[1]) - p0, e2 = glm::dvec3(corner[2]) - p0;
  const glm::dvec3 across = glm::cross(direction, e2), s = origin - p0, along = glm::cross(s, e1);
  const double determinant = glm::dot(e1, across);
  const glm::dvec2 rounded(hit.u, hit.v);
  if (determinant == 0) return rounded;
  const glm::dvec2 exact = glm::dvec2(glm::dot(s, across), glm::dot(direction, along)) / determinant;
  // The ray was rounded for the search, so at an edge its exact form may pass by the triangle: never extrapolate from
  // that.
  const glm::dvec2 inside(std::clamp(exact.x, 0.0, 1.0), std::clamp(exact.y, 0.0, 1.0));
  if (!(glm::length(inside - rounded) < 1e-2)) return rounded;
  return inside.x + inside.y > 1 ? inside / (inside.x + inside.y) : inside;
}

// The place of the triangle nearest to one beside it, as far as the weights go.
glm::dvec3 within_triangle(glm::dvec2 b) {
  const glm::dvec3 w = glm::max(glm::dvec3(1 - b.x - b.y, b), glm::dvec3(0));
  return w / (w.x + w.y + w.z);
}

}  // namespace

ReliefLayer World::relief_layer(uint32_t item_index, uint32_t primitive) const {
  const TracedItem& item = items_[item_index];
  const Material& m = item.material->material;
  const MeshSection& s = *item.section;
  const PosedTriangle triangle = accel_.triangle(item_index, primitive);
  const DrawItem& drawn = input_.frame.items[item_index];
  const bool skinned = drawn.deformed >= 0 && input_.frame.deformations[size_t(drawn.deformed)].joint_count > 0;
  const std::vector<glm::vec3>& positions =
      item.deformed && !item.deformed->position.empty() ? item.deformed->position : s.position;
  ReliefLayer layer;
  glm::dvec3 local[3];
  for (size_t i = 0; i < 3; ++i) local[i] = positions[triangle.vertex[i]];
  layer.below = -double(m.relief.depth) * unit_or_zero(glm::cross(local[1] - local[0], local[2] - local[0]));
  if (!skinned) layer.below = glm::dmat3(item.relative_from_local) * layer.below;
  layer.corner = triangle.position[0];
  const std::vector<glm::vec2>& uvs = m.relief.texture.uv_set == 1 ? s.uv1 : s.uv0;
  layer.uv_edge[0] = layer.uv_edge[1] = glm::dvec2(0);
  if (!uvs.empty()) layer.uv = uvs[triangle.vertex[0]];
  for (size_t i = 0; i < 2; ++i) {
    layer.edge[i] = glm::dvec3(triangle.position[i + 1]) - layer.corner;
    if (!uvs.empty()) layer.uv_edge[i] = glm::dvec2(uvs[triangle.vertex[i + 1]]) - layer.uv;
  }
  layer.least_uv = item.least_uv, layer.most_uv = item.most_uv;
  layer.ends = m.relief.silhouettes && !uvs.empty();
  layer.heights = item.material->heights;
  layer.slot = &m.relief.texture;
  layer.sampler = &input_.scene.samplers[size_t(m.relief.texture.sampler)];
  return layer;
}

namespace {
std::optional<Hit> hit_of(const std::optional<ReliefHit>& met, uint32_t item, uint32_t primitive, bool back) {
  if (!met) return {};
  return Hit{float(met->t), float(met->weights.x), float(met->weights.y), item, primitive, back};
}
}  // namespace

std::optional<Hit> World::meet_relief(const Ray& ray, const Hit& candidate) const {
  const ReliefLayer layer = relief_layer(candidate.item, candidate.primitive);
  if (layer.below == glm::dvec3(0) || glm::cross(layer.edge[0], layer.edge[1]) == glm::dvec3(0)) return candidate;
  const auto met = reference::meet_relief(layer, ray.origin, ray.direction, ray.t_min, ray.t_max);
  // From behind the ray meets the floor, a flat back; what it meets inside is the surface, seen from its front.
  const bool floor = candidate.back && met && met->depth >= 1;
  return hit_of(met, candidate.item, candidate.primitive, floor);
}

std::optional<Hit> World::leave_relief(const Ray& ray) const {
  if (ray.relief_item == no_relief) return {};
  const ReliefLayer layer = relief_layer(ray.relief_item, ray.relief_primitive);
  return hit_of(reference::meet_relief(layer, ray.origin, ray.direction, ray.t_min, ray.t_max), ray.relief_item,
                ray.relief_primitive, false);
}

SurfacePoint World::point(const Hit& hit) const {
  if (!has_relief(hit.item)) return accel_.surface(hit);
  SurfacePoint out = accel_.surface({hit.t, 1.f / 3, 1.f / 3, hit.item, hit.primitive, hit.back});
  const ReliefLayer layer = relief_layer(hit.item, hit.primitive);
  const glm::dvec2 weights(hit.u, hit.v);
  if (hit.back) {
    out.position = layer.position(weights, 1);
    return out;
  }
  const glm::dvec2 slope = layer.slope(weights, false);
  out.position = layer.position(weights, layer.height(weights));
  // The weights' own rounding, along the plane and by the slope in depth.
  const double reach =
      (std::abs(weights.x) + 1) * glm::length(layer.edge[0]) + (std::abs(weights.y) + 1) * glm::length(layer.edge[1]);
  const double rise = (std::abs(slope.x) * (std::abs(weights.x) + 1) + std::abs(slope.y) * (std::abs(weights.y) + 1)) *
                      glm::length(layer.below);
  out.error_m += float((reach + rise + glm::length(layer.below)) * 0x1p-22);
  const glm::dvec3 normal = unit_or_zero(layer.leaned(out.geometric_normal, slope));
  if (normal != glm::dvec3(0)) out.geometric_normal = normal;
  out.relief_item = hit.item, out.relief_primitive = hit.primitive;
  return out;
}

World::Vertex World::vertex_at(const TracedItem& item, const std::array<uint32_t, 3>& corner, glm::dvec3 weight) const {
  const MeshSection& s = *item.section;
  Vertex v;
  const std::vector<glm::vec3>& normals =
      item.deformed && !item.deformed->normal.empty() ? item.deformed->normal : s.normal;
  const std::vector<glm::vec4>& tangents =
      item.deformed && !item.deformed->tangent.empty() ? item.deformed->tangent : s.tangent;
  v.uv[0] = v.uv[1] = glm::dvec2(0);
  if (!s.color.empty()) v.color = glm::dvec4(0);
  const glm::dmat3 linear(item.relative_from_local);
  for (int i = 0; i < 3; ++i) {
    const size_t k = corner[size_t(i)];
    // Unit vectors at the vertices, not normalised in between: as MikkTSpace wants it (Mikkelsen 2008).
    if (!normals.empty()) v.normal += weight[i] * unit_or_zero(item.normal_from_local * glm::dvec3(normals[k]));
    if (!tangents.empty())
      v.tangent +=
          weight[i] * glm::dvec4(unit_or_zero(linear * glm::dvec3(tangents[k])), double(tangents[k].w) * item.mirrored);
    if (!s.uv0.empty()) v.uv[0] += weight[i] * glm::dvec2(s.uv0[k]);
    if (!s.uv1.empty()) v.uv[1] += weight[i] * glm::dvec2(s.uv1[k]);
    if (!s.color.empty()) v.color += weight[i] * glm::dvec4(s.color[k]);
  }
  return v;
}

glm::dvec4 World::fetch(const Texture* texture, const TextureSlot& slot, const Vertex& v) const {
  return texture->sample(transformed_uv(slot, v.uv[slot.uv_set == 1 ? 1 : 0]),
                         input_.scene.samplers[size_t(slot.sampler)]);
}

glm::dvec4 World::fetch_colour(const Texture* texture, const TextureSlot& slot, const Vertex& v,
                               bool premultiplied) const {
  if (!v.uv_sides) return fetch(texture, slot, v);
  const size_t set = slot.uv_set == 1 ? 1 : 0;
  const glm::dvec2 uv = transformed_uv(slot, v.uv[set]);
  glm::dvec2 sides[2];
  for (size_t i = 0; i < 2; ++i) sides[i] = transformed_uv(slot, v.uv[set] + (*v.uv_sides)[set][i]) - uv;
  return texture->mean(uv, sides, input_.scene.samplers[size_t(slot.sampler)], premultiplied);
}

glm::dvec4 World::base_color(const TracedMaterial& m, const Vertex& v) const {
  glm::dvec4 c = glm::dvec4(m.material.base_color) * v.color;
  // What a mask cuts out is not linear in it: there the colour is the point's.
  const AlphaMode mode = m.material.alpha_mode;
  if (m.base && mode == AlphaMode::mask) c *= fetch(m.base, m.material.base_color_texture, v);
  if (m.base && mode != AlphaMode::mask)
    c *= fetch_colour(m.base, m.material.base_color_texture, v, mode == AlphaMode::blend);
  return c;
}

glm::dvec3 World::emission_at(const TracedMaterial& m, const Vertex& v) const {
  if (m.material.unlit) return glm::dvec3(0);
  glm::dvec3 e = glm::dvec3(m.material.emissive) * double(m.material.emissive_strength);
  if (m.emissive && e != glm::dvec3(0))
    e *= glm::dvec3(fetch_colour(m.emissive, m.material.emissive_texture, v, false));
  return e;
}

glm::dvec3 World::mapped_normal(const Texture* map, const TextureSlot& slot, double scale, const Vertex& v) const {
  if (!map || !(glm::dot(glm::dvec3(v.tangent), glm::dvec3(v.tangent)) > 0)) return v.normal;
  const glm::dvec3 n = (glm::dvec3(fetch(map, slot, v)) * 2.0 - 1.0) * glm::dvec3(scale, scale, 1);
  const glm::dvec3 tangent(v.tangent), bitangent = v.tangent.w * glm::cross(v.normal, tangent);
  return n.x * tangent + n.y * bitangent + n.z * v.normal;
}

glm::dvec3 World::normal_at(const TracedMaterial& t, const Vertex& v, bool back, glm::dvec3 to_viewer) const {
  const glm::dvec3 n = unit_or_zero(mapped_normal(t.normal, t.material.normal_texture, t.material.normal_scale, v));
  // The whole frame turns over on back faces (glTF 3.9.6).
  return n == glm::dvec3(0) ? to_viewer : back ? -n : n;
}

std::array<glm::dvec3, 2> World::turn(const Hit& hit, glm::dvec2 b, glm::dvec3 to_viewer) const {
  // Central differences: a step that keeps ten digits, of both their errors.
  constexpr double step = 1e-5;
  const TracedItem& item = items_[hit.item];
  const PosedTriangle triangle = accel_.triangle(hit.item, hit.primitive);
  const auto normal = [&](glm::dvec2 at) {
    const Vertex v = vertex_at(item, triangle.vertex, {1 - at.x - at.y, at.x, at.y});
    return normal_at(*item.material, v, hit.back, to_viewer);
  };
  std::array<glm::dvec3, 2> out;
  for (int i = 0; i < 2; ++i) {
    glm::dvec2 aside(0);
    aside[i] = step;
    out[size_t(i)] = (normal(b + aside) - normal(b - aside)) / (2 * step);
  }
  return out;
}

std::optional<Lobes> World::lobes_at(const TracedMaterial& t, const Vertex& v, glm::dvec3 normal, glm::dvec3 to_viewer,
                                     bool back) const {
  const Material& m = t.material;
  Lobes lobes;
  // Layers lie outside a body: who looks from inside it sees none.
  const bool inside = back && t.glass && t.glass->body;
  if (m.has(Lobe::clearcoat) && !inside) {
    lobes.clearcoat = m.clearcoat.factor, lobes.clearcoat_roughness = m.clearcoat.roughness;
    if (t.clearcoat) lobes.clearcoat *= fetch(t.clearcoat, m.clearcoat.texture, v).x;
    if (t.clearcoat_roughness)
      lobes.clearcoat_roughness *= fetch(t.clearcoat_roughness, m.clearcoat.roughness_texture, v).y;
    lobes.clearcoat = std::clamp(lobes.clearcoat, 0.0, 1.0);
    const glm::dvec3 coat =
        unit_or_zero(mapped_normal(t.clearcoat_normal, m.clearcoat.normal_texture, m.clearcoat.normal_scale, v));
    lobes.clearcoat_normal = coat == glm::dvec3(0) ? to_viewer : back ? -coat : coat;
  }
  if (m.has(Lobe::sheen) && !inside) {
    lobes.sheen_color = m.sheen.color, lobes.sheen_roughness = m.sheen.roughness;
    if (t.sheen_color) lobes.sheen_color *= glm::dvec3(fetch(t.sheen_color, m.sheen.color_texture, v));
    if (t.sheen_roughness) lobes.sheen_roughness *= fetch(t.sheen_roughness, m.sheen.roughness_texture, v).w;
    lobes.sheen_color = glm::clamp(lobes.sheen_color, glm::dvec3(0), glm::dvec3(1));
  }
  if (m.has(Lobe::iridescence)) {
    lobes.iridescence = m.iridescence.factor, lobes.film_ior = m.iridescence.ior;
    if (t.iridescence) lobes.iridescence *= fetch(t.iridescence, m.iridescence.texture, v).x;
    lobes.iridescence = std::clamp(lobes.iridescence, 0.0, 1.0);
    const double along = t.film_thickness ? fetch(t.film_thickness, m.iridescence.thickness_texture, v).y : 1;
    lobes.film_nm = glm::mix(double(m.iridescence.least_nm), double(m.iridescence.most_nm), along);
  }
  if (m.has(Lobe::anisotropy)) {
    lobes.anisotropy = m.anisotropy.strength;
    glm::dvec2 way(1, 0);
    if (t.anisotropy) {
      const glm::dvec3 texel(fetch(t.anisotropy, m.anisotropy.texture, v));
      way = glm::dvec2(texel) * 2.0 - 1.0;
      lobes.anisotropy *= texel.z;
    }
    lobes.anisotropy = std::clamp(lobes.anisotropy, 0.0, 1.0);
    const double sine = std::sin(double(m.anisotropy.rotation_rad)),
                 cosine = std::cos(double(m.anisotropy.rotation_rad));
    const glm::dvec3 tangent(v.tangent), bitangent = v.tangent.w * glm::cross(v.normal, tangent);
    const glm::dvec3 along = (cosine * way.x - sine * way.y) * tangent + (sine * way.x + cosine * way.y) * bitangent;
    lobes.along = unit_or_zero(along - glm::dot(along, normal) * normal);
    // Without a direction (no tangents, or one along the normal) facets are as wide every way.
    if (!(glm::length(along - glm::dot(along, normal) * normal) > 1e-9)) lobes.anisotropy = 0;
  }
  if (m.has(Lobe::diffuse_transmission)) {
    lobes.diffuse_transmission = m.diffuse_transmission.factor, lobes.transmitted_color = m.diffuse_transmission.color;
    if (t.diffuse_transmission)
      lobes.diffuse_transmission *= fetch(t.diffuse_transmission, m.diffuse_transmission.texture, v).w;
    if (t.transmitted_color)
      lobes.transmitted_color *= glm::dvec3(fetch(t.transmitted_color, m.diffuse_transmission.color_texture, v));
    lobes.diffuse_transmission = std::clamp(lobes.diffuse_transmission, 0.0, 1.0);
    lobes.transmitted_color = glm::max(lobes.transmitted_color, glm::dvec3(0));
  }
  const bool any = lobes.clearcoat > 0 || lobes.sheen_color != glm::dvec3(0) || lobes.iridescence > 0 ||
                   lobes.anisotropy > 0 || lobes.diffuse_transmission > 0;
  return any ? std::optional(lobes) : std::nullopt;
}

double World::coverage_of(const Material& m, double alpha) {
  if (m.alpha_mode == AlphaMode::blend) return std::clamp(alpha, 0.0, 1.0);
  if (m.alpha_mode == AlphaMode::mask) return alpha < double(m.alpha_cutoff) ? 0 : 1;
  return 1;
}

double World::coverage(const Hit& hit) const {
  const TracedItem& item = items_[hit.item];
  if (item.material->material.alpha_mode == AlphaMode::opaque) return 1;
  if (item.section->metaballs >= 0) return coverage_of(item.material->material, base_color(*item.material, Vertex{}).w);
  const std::vector<uint32_t>& index = item.section->index;
  const size_t at = 3 * size_t(hit.primitive);
  const Vertex v = vertex_at(item, {index[at], index[at + 1], index[at + 2]},
                             {1 - double(hit.u) - double(hit.v), double(hit.u), double(hit.v)});
  return coverage_of(item.material->material, base_color(*item.material, v).w);
}

glm::dvec2 World::weights(const Hit& hit, glm::dvec3 origin, glm::dvec3 direction) const {
  if (has_relief(hit.item)) {
    const ReliefHit near{double(hit.t), {hit.u, hit.v}, hit.back ? 1.0 : 0.0};
    if (hit.back) return near.weights;
    return refined(relief_layer(hit.item, hit.primitive), origin, direction, near).weights;
  }
  return barycentrics_of(accel_.triangle(hit.item, hit.primitive).position, hit, origin, direction);
}

Surface World::implicit_surface(const MetaballSurface& body, const Hit& hit, glm::dvec3 direction, glm::dvec3 to_viewer,
                                bool back) const {
  const glm::dvec3 position = body.polished(glm::dvec3(hit.point), direction);
  Vertex v;
  v.uv[0] = v.uv[1] = glm::dvec2(0);
  v.normal = body.shading_normal(position);
  return shaded_surface(items_[hit.item], v, position, body.geometric_normal(position), back, to_viewer);
}

Surface World::surface(const Hit& hit, glm::dvec3 origin, glm::dvec3 direction, const RayDifferential* beside) const {
  if (const MetaballSurface* body = accel_.implicit(hit.item)) {
    // Of the ray before it was rounded for the search.
    Hit exact = hit;
    const glm::dvec3 along = glm::dvec3(hit.point) - origin;
    exact.point = origin + direction * (glm::dot(along, direction) / glm::dot(direction, direction));
    return implicit_surface(*body, exact, direction, -glm::normalize(direction), hit.back);
  }
  const glm::dvec2 b = weights(hit, origin, direction);
  const glm::dvec3 to_viewer = -glm::normalize(direction);
  if (!beside) return surface_at(hit.item, hit.primitive, b, hit.back, to_viewer);
  const PosedTriangle triangle = accel_.triangle(hit.item, hit.primitive);
  const glm::dvec3 p0(triangle.position[0]), e1 = glm::dvec3(triangle.position[1]) - p0,
                                             e2 = glm::dvec3(triangle.position[2]) - p0;
  RayDifferential there = *beside;
  const double distance = glm::dot(p0 + b.x * e1 + b.y * e2 - origin, direction) / glm::dot(direction, direction);
  there.go(direction, distance, unit_or_zero(glm::cross(e1, e2)));
  const glm::dmat2 area(weights_of_step(e1, e2, there.place[0]), weights_of_step(e1, e2, there.place[1]));
  return surface_at(hit.item, hit.primitive, b, hit.back, to_viewer, &area);
}

Surface World::surface_from(const Hit& hit, glm::dvec3 origin, glm::dvec3 direction, glm::dvec3 eye) const {
  if (const MetaballSurface* body = accel_.implicit(hit.item)) {
    const glm::dvec3 to_eye = unit_or_zero(eye - glm::dvec3(hit.point));
    const glm::dvec3 normal = body->geometric_normal(glm::dvec3(hit.point));
    const bool other_side = glm::dot(normal, to_eye) * glm::dot(normal, direction) > 0;
    return implicit_surface(*body, hit, direction, to_eye, hit.back != other_side);
  }
  const PosedTriangle triangle = accel_.triangle(hit.item, hit.primitive);
  const glm::dvec2 b = weights(hit, origin, direction);
  const glm::dvec3 p0(triangle.position[0]), e1 = glm::dvec3(triangle.position[1]) - p0,
                                             e2 = glm::dvec3(triangle.position[2]) - p0;
  const glm::dvec3 to_eye = unit_or_zero(eye - (p0 + b.x * e1 + b.y * e2)), normal = glm::cross(e1, e2);
  const bool other_side = glm::dot(normal, to_eye) * glm::dot(normal, direction) > 0;
  return surface_at(hit.item, hit.primitive, b, hit.back != other_side, to_eye);
}

Surface World::surface_at(uint32_t item_index, uint32_t primitive, glm::dvec2 b, bool back, glm::dvec3 to_viewer,
                          const glm::dmat2* area) const {
  const TracedItem& item = items_[item_index];
  const TracedMaterial& t = *item.material;
  const PosedTriangle triangle = accel_.triangle(item_index, primitive);
  const glm::dvec3 weight(1 - b.x - b.y, b.x, b.y);
  Vertex v = vertex_at(item, triangle.vertex, weight);
  if (t.heights) {
    // Beside the triangle textures go on, and what else its corners have does not.
    const Vertex inside = vertex_at(item, triangle.vertex, within_triangle(b));
    v.normal = inside.normal, v.tangent = inside.tangent, v.color = inside.color;
  }
  if (area) {
    v.uv_sides.emplace();
    for (size_t i = 0; i < 2; ++i) {
      const glm::dvec2 there = b + (*area)[int(i)];
      const Vertex aside = vertex_at(item, triangle.vertex, {1 - there.x - there.y, there.x, there.y});
      for (size_t set = 0; set < 2; ++set) (*v.uv_sides)[set][i] = aside.uv[set] - v.uv[set];
    }
  }

  const glm::dvec3 p0(triangle.position[0]), p1(triangle.position[1]), p2(triangle.position[2]);
  glm::dvec3 position = weight.x * p0 + weight.y * p1 + weight.z * p2,
             geometric = unit_or_zero(glm::cross(p1 - p0, p2 - p0));
  if (t.heights) {
    const ReliefLayer layer = relief_layer(item_index, primitive);
    position = layer.position(b, back ? 1 : layer.height(b));
    if (!back) {
      if (glm::dot(geometric, layer.below) > 0) geometric = -geometric;
      geometric = unit_or_zero(layer.leaned(geometric, layer.slope(b, false)));
      // A normal map says how its surface leans; without one its heights do.
      if (!t.normal) v.normal = layer.leaned(v.normal, layer.slope(b, true));
    }
  }
  return shaded_surface(item, v, position, geometric, back, to_viewer);
}

Surface World::shaded_surface(const TracedItem& item, const Vertex& v, glm::dvec3 position, glm::dvec3 geometric,
                              bool back, glm::dvec3 to_viewer) const {
  const TracedMaterial& t = *item.material;
  const Material& m = t.material;
  Surface s;
  s.position = position;
  s.geometric = geometric;
  if (glm::dot(s.geometric, to_viewer) < 0) s.geometric = -s.geometric;
  const glm::dvec4 base = base_color(t, v);
  s.base_color = glm::max(glm::dvec3(base), glm::dvec3(0));
  s.coverage = coverage_of(m, base.w);
  s.unlit = item.unlit;
  if (s.unlit) {
    s.normal = s.geometric;
    return s;
  }
  s.metallic = m.metallic;
  s.roughness = stated_roughness(m);
  if (t.orm) {
    const glm::dvec4 orm = fetch(t.orm, m.orm_texture, v);
    if (m.orm_has_metallic_roughness) s.roughness *= orm.y, s.metallic *= orm.z;
    if (m.orm_has_occlusion) s.occlusion = 1 + double(m.occlusion_strength) * (orm.x - 1);
  }
  if (t.occlusion) s.occlusion = 1 + double(m.occlusion_strength) * (fetch(t.occlusion, m.occlusion_texture, v).x - 1);
  s.metallic = std::clamp(s.metallic, 0.0, 1.0);
  s.roughness = std::clamp(s.roughness, 0.0, 1.0);

  s.normal = normal_at(t, v, back, to_viewer);
  s.emission = emission_at(t, v);

  // KHR_materials_ior and KHR_materials_specular; ior 0 stands for f0 = 1.
  double specular = m.specular;
  glm::dvec3 specular_color(m.specular_color);
  const double alpha = t.specular ? fetch(t.specular, m.specular_texture, v).w : 1;
  if (!m.blinn_phong.stated) specular *= alpha;
  if (t.specular_color) specular_color *= glm::dvec3(fetch(t.specular_color, m.specular_color_texture, v));
  const double ratio = m.ior == 0 ? 1 : (double(m.ior) - 1) / (double(m.ior) + 1);
  s.dielectric_f0 = glm::min(ratio * ratio * specular_color, glm::dvec3(1)) * specular;
  s.dielectric_f90 = specular;
  if (m.blinn_phong.shades) {
    s.exponent = exponent_of_roughness(s.roughness) * (m.blinn_phong.stated ? alpha : 1);
    return s;
  }
  s.lobes = lobes_at(t, v, s.normal, to_viewer, back);
  if (t.slab && s.lobes) {
    double thickness_m = m.thickness_m;
    if (t.thickness) thickness_m *= fetch(t.thickness, m.thickness_texture, v).y;
    // In the mesh's space: by the cube root of what the transform makes of volumes.
    thickness_m *= std::cbrt(std::abs(glm::determinant(glm::dmat3(item.relative_from_local))));
    const SlabShares wall{diffuse_color(s, true), diffuse_color(s, false)};
    thickness_m = std::min(thickness_m, 1e15);
    const SlabShares all = between_walls(slab_shares(*t.slab, thickness_m), wall);
    s.lobes->slab = Lobes::Slab{all.reflected, all.through, thickness_m};
  }
  const glm::dvec3 f0 = glm::mix(s.dielectric_f0, s.base_color, s.metallic);
  s.specular_gain = is_stretched(s)
                        ? specular_gain(f0, facets_of(s), to_viewer)
                        : specular_gain(f0, s.roughness, std::min(std::abs(glm::dot(s.normal, to_viewer)), 1.0));
  if (s.lobes) s.emission *= share_under_coat(*s.lobes, to_viewer);
  if (t.glass) {
    s.specular_tint = specular_color;
    s.transmission = m.transmission;
    if (t.transmission) s.transmission *= std::clamp(fetch(t.transmission, m.transmission_texture, v).x, 0.0, 1.0);
    if (s.transmission > 0 && s.metallic < 1) s.glass = &*t.glass;
    if (t.glass->body && (s.glass || t.glass->medium)) s.body = &*t.glass;
  }
  return s;
}

}  // namespace candela::reference
