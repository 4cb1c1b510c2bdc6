#include <algorithm>
#include <cmath>
#include <numbers>

#include "demoscenes/dusk.h"
#include "demoscenes/tile_maps.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

namespace candela::dusk {
namespace {

constexpr int clamp_to_edge = 33071, nearest = 9728, linear = 9729, linear_mipmap_linear = 9987;

json trilinear(bool clamped) {
  json sampler = {{"magFilter", linear}, {"minFilter", linear_mipmap_linear}};
  if (clamped) sampler["wrapS"] = sampler["wrapT"] = clamp_to_edge;
  return sampler;
}

class Maker {
 public:
  Maker(GlbWriter& out, uint64_t seed) : out_(out), seed_(seed) {}

  using Point = TilePoint (*)(double, double, uint64_t);
  TileMaps bake(int size, double side_m, Point point) const {
    return bake_tile(size, side_m, [=, this](double u, double v) { return point(u, v, seed_); });
  }
  json textured(std::string_view name, const TileMaps& maps, bool rough_map, double roughness, double metallic) {
    json material = pbr_textured(texture(std::string(name) + " colour", maps.color), metallic, roughness);
    material["normalTexture"] = {{"index", texture(std::string(name) + " normal", maps.normal)}};
    if (rough_map)
      material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {
          {"index", texture(std::string(name) + " roughness", maps.roughness)}};
    return material;
  }
  int texture(const std::string& name, std::span<const std::byte> png, bool clamped = false) {
    return out_.texture(name, png, trilinear(clamped));
  }
  int glowing(const char* name, const Atlas& atlas, double strength, double roughness, json sampler = trilinear(true)) {
    json material = pbr({0.03, 0.03, 0.035, 1}, 0, roughness);
    material["emissiveTexture"] = {{"index", out_.texture(name, atlas.png, std::move(sampler))}};
    material["emissiveFactor"] = {1, 1, 1};
    out_.use_extension("KHR_materials_emissive_strength");
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", number(strength)}};
    return out_.material(name, material);
  }
  Paint flat(const char* name, double roughness, double metallic) {
    return {out_.material(name, pbr({1, 1, 1, 1}, metallic, roughness))};
  }

 private:
  GlbWriter& out_;
  uint64_t seed_;
};

}  // namespace

Materials make_materials(GlbWriter& out, uint64_t seed, double least_puddle_roughness, bool near_shops) {
  Maker make(out, seed);
  Materials m;
  {
    constexpr double tile_m = 4, puddles_m = 24;
    json asphalt = make.textured("asphalt", make.bake(512, tile_m, asphalt_point), false, 1, 0);
    const auto puddles = png_from(512, 512, 3, [=](double u, double v) {
      return glm::dvec4(1, std::max(puddle_roughness(u, v, seed), least_puddle_roughness), 0, 1);
    });
    // Water stands in other places than the grain repeats.
    out.use_extension("KHR_texture_transform");
    const double scale = tile_m / puddles_m;
    asphalt["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {
        {"index", make.texture("puddles", puddles)},
        {"extensions", {{"KHR_texture_transform", {{"scale", {number(scale), number(scale)}}}}}}};
    m.asphalt = {out.material("wet asphalt", asphalt), tile_m};
  }
  m.pavement = {out.material("pavement", make.textured("pavement", make.bake(512, 2.4, pavement_point), true, 1, 0)),
                2.4};
  m.brick = {out.material("brick", make.textured("brick", make.bake(256, 1.92, brick_point), false, 0.8, 0)), 1.92};
  const json plaster = make.textured("plaster", make.bake(256, 3, plaster_point), false, 0.78, 0);
  m.plaster = {out.material("plaster", plaster), 3};
  m.stone = {out.material("stone", plaster), 3};
  out.root["materials"][size_t(m.stone.material)]["pbrMetallicRoughness"]["roughnessFactor"] = 0.55;
  m.metal = {out.material("iron", make.textured("iron", make.bake(128, 1, metal_point), true, 1, 1)), 1};
  m.car_paint = make.flat("car paint", 0.24, 0.25);
  m.chrome = make.flat("chrome", 0.2, 1);
  m.glass = make.flat("glass", 0.06, 0);
  m.matte = make.flat("matte", 0.75, 0);
  m.line_paint = make.flat("road paint", 0.3, 0);
  m.bark = m.matte;
  json leaf = pbr({1, 1, 1, 1}, 0, 0.55);
  leaf["doubleSided"] = true;
  m.leaf = {out.material("leaf", leaf)};
  m.rooms = make.glowing("rooms", make_rooms(seed), 3.4, 0.12);
  m.shops = make.glowing("shops", near_shops ? make_near_shops(seed) : make_shops(seed), 2.2, 0.1);
  m.lying_signs = make.glowing("lying signs", make_lying_signs(), 7, 0.35);
  m.standing_signs = make.glowing("standing signs", make_standing_signs(), 7, 0.35);
  m.glows = make.glowing("glow", make_glows(), 24, 0.3, {{"magFilter", nearest}, {"minFilter", nearest}});
  return m;
}

void glow_quad(MeshKit& kit, const Materials& m, glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, Glow glow) {
  kit.quad({m.glows}, corner, u, v, glow_uv(glow), glow_uv(glow));
}

void glow_band(MeshKit& kit, const Materials& m, glm::dvec3 centre, glm::dvec2 low, glm::dvec2 high, int sides,
               Glow glow) {
  const auto at = [&](int i, glm::dvec2 circle) {
    const double angle = -2 * std::numbers::pi * i / sides;
    return centre + glm::dvec3(circle.x * std::cos(angle), circle.y, circle.x * std::sin(angle));
  };
  for (int i = 0; i < sides; ++i) {
    std::vector<glm::dvec3> points{at(i, low), at(i + 1, low), at(i + 1, high), at(i, high)};
    if (low.x == 0) points.erase(points.begin());
    if (high.x == 0) points.pop_back();
    kit.polygon({m.glows}, points, glow_uv(glow));
  }
}

void Instances::add(int mesh, glm::dvec3 at, double turn_rad, double scale) {
  Places& p = places_[mesh];
  p.translation.insert(p.translation.end(), {at.x, at.y, at.z});
  const glm::dquat q = rotation_about({0, 1, 0}, turn_rad);
  p.rotation.insert(p.rotation.end(), {q.x, q.y, q.z, q.w});
  p.scale.insert(p.scale.end(), {scale, scale, scale});
}

void Instances::write(GlbWriter& out, std::string_view name, int parent) const {
  for (const auto& [mesh, p] : places_) {
    out.use_extension("EXT_mesh_gpu_instancing");
    json attributes = {{"TRANSLATION", out.float_accessor(p.translation, 3)},
                       {"ROTATION", out.float_accessor(p.rotation, 4)}};
    if (std::ranges::any_of(p.scale, [](double s) { return s != 1; }))
      attributes["SCALE"] = out.float_accessor(p.scale, 3);
    json node = {{"mesh", mesh}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}};
    if (parent < 0)
      out.node(name, node);
    else
      out.child(parent, name, node);
  }
}

}  // namespace candela::dusk
