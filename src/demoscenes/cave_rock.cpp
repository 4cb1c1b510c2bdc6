#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "demoscenes/cave.h"
#include "demoscenes/tile_maps.h"
#include "testscenes/procedural_textures.h"
#include "testscenes/table.h"

// The hall: rock by formula, its pool, and the wall at its end.
namespace candela::cave {
namespace {

using std::numbers::pi;

json textured_material(GlbWriter& out, const std::string& name, const TileMaps& maps) {
  json material = pbr_textured(out.texture(name + " colour", maps.color, trilinear()), 0, 1);
  material["normalTexture"] = {{"index", out.texture(name + " normal", maps.normal, trilinear())}};
  material["pbrMetallicRoughness"]["metallicRoughnessTexture"] = {
      {"index", out.texture(name + " roughness", maps.roughness, trilinear())}};
  return material;
}

// Rock that water has run over, 3 m: cracks, grain, smooth films of lime.
TilePoint rock_point(double u, double v, uint64_t seed) {
  const double broad = tiling_octaves(u, v, 4, 5, seed), grain = tiling_noise(u, v, 150, seed + 1);
  const double fine = tiling_octaves(u, v, 24, 4, seed + 2);
  const double fold = std::abs(tiling_octaves(u, v, 5, 5, seed + 3) - 0.5);
  const double crack = 1 - smooth_step(0.0, 0.012, fold),
               wet = smooth_step(0.42, 0.66, tiling_octaves(u, v, 6, 4, seed + 4));
  TilePoint p;
  const glm::dvec3 lime(0.56, 0.48, 0.38), clay(0.33, 0.25, 0.19);
  p.color = glm::mix(clay, lime, smooth_step(0.3, 0.7, broad)) * (0.72 + 0.4 * fine) * (0.92 + 0.16 * grain) *
            (1 - 0.35 * crack) * (1 - 0.22 * wet);
  p.height_m = 0.06 * broad + 0.03 * fine + 0.004 * grain * (1 - wet) - 0.018 * crack;
  p.roughness = std::clamp(0.92 - 0.2 * wet + 0.1 * (grain - 0.5), 0.76, 0.95);
  return p;
}

double pool_at(glm::dvec2 at) {
  const glm::dvec3 p(at.x, 0, at.y);
  const double d = glm::length(glm::dvec2((at.x - 0.3) / 3.7, (at.y + 2.5) / 3.0)) + 0.22 * fbm3(p * 0.7, 3, 71);
  return 1 - smooth_step(0.72, 1.08, d);
}

// --- the wall

struct Wall {
  glm::dvec3 centre{4.15, 2.3, -8.5}, right, up{0, 1, 0}, front;
  double width = 5.8, height = 5.2;
};
Wall wall() {
  Wall w;
  w.front = glm::normalize(glm::dvec3(-0.42, 0, 0.9));
  w.right = glm::cross(w.up, w.front);
  return w;
}

// Courses of squared stones, 0.4 m high, of uneven lengths, over the unit square of 3.2 m: 0 on top, 1 in the joints.
struct Masonry {
  double depth, stone, shade;
};
double number_of(int a, int b, uint64_t seed) {
  Rng rng(seed * 7919 + uint64_t(a) * 104729 + uint64_t(b) * 1299709);
  rng.next();
  return rng.uniform();
}
Masonry masonry_at(double u, double v, uint64_t seed) {
  constexpr int courses = 10, stones = 6;
  // Joints are not quite straight.
  v += 0.006 * (tiling_noise(u, v, 9, seed + 31) - 0.5), u += 0.008 * (tiling_noise(u, v, 11, seed + 32) - 0.5);
  u -= std::floor(u), v -= std::floor(v);
  const double y = v * courses;
  const int row = int(y) % courses;
  const auto edge_of = [&](int k) {
    const int wrapped = (k % stones + stones) % stones;
    return (k + 0.5 * (row % 2) + 0.5 * (number_of(row, wrapped, seed) - 0.5)) / stones;
  };
  int k = int(std::floor(u * stones)) - 2;
  while (edge_of(k + 1) <= u) ++k;
  const int stone = (k % stones + stones) % stones;
  constexpr double side_m = 3.2;
  const double x_m = std::min(u - edge_of(k), edge_of(k + 1) - u) * side_m;
  const double fy = y - std::floor(y), y_m = std::min(fy, 1 - fy) * side_m / courses;
  const double chip = 0.018 * tiling_octaves(u, v, 24, 3, seed + 5);
  const double edge = smooth_step(0.008, 0.055, std::min(x_m, y_m) - chip);
  const double own = number_of(row + 100, stone, seed), tilt = (fy - 0.5) * (number_of(row + 200, stone, seed) - 0.5);
  const double rough = 0.16 * tiling_octaves(u, v, 16, 4, seed + 6) + 0.22 * own + 0.18 * tilt;
  return {std::clamp(1 - edge * (1 - std::max(rough, 0.0)), 0.0, 1.0), own, edge};
}

void add_wall(GlbWriter& out, uint64_t seed) {
  constexpr int size = 512;
  constexpr double tile_m = 3.2;
  out.use_extension("CANDELA_relief");
  const int heights = out.texture(
      "wall heights",
      png_from(96, 96, 3, [&](double u, double v) { return glm::dvec4(glm::dvec3(masonry_at(u, v, seed).depth), 1); }),
      trilinear());
  const int colors = out.texture(
      "wall colour",
      png_from(size, size, 3,
               [&](double u, double v) {
                 const Masonry m = masonry_at(u, v, seed);
                 const double grain = tiling_octaves(u, v, 40, 3, seed + 8);
                 const double stain = tiling_octaves(u, v, 3, 4, seed + 9);
                 const glm::dvec3 stone = glm::mix(glm::dvec3(0.22, 0.14, 0.1), glm::dvec3(0.52, 0.4, 0.29), m.stone);
                 const glm::dvec3 color = glm::mix(glm::dvec3(0.1, 0.085, 0.07), stone, m.shade) * (0.7 + 0.5 * grain) *
                                          (0.65 + 0.6 * stain);
                 return glm::dvec4(srgb_of(glm::min(color, 1.0)), 1);
               }),
      trilinear());
  json stones = pbr_textured(colors, 0, 0.85);
  stones["extensions"]["CANDELA_relief"] = {{"heightTexture", {{"index", heights}}}, {"depth", 0.02}};
  const int material = out.material("wall", stones);
  const Wall w = wall();
  Shape shape;
  for (int k = 0; k < 4; ++k) {
    const double x = k == 1 || k == 2 ? 1 : -1, y = k >= 2 ? 1 : -1;
    shape.position.push_back(w.centre + w.right * (x * w.width / 2) + w.up * (y * w.height / 2));
    shape.normal.push_back(w.front);
    shape.uv.emplace_back(x * w.width / 2 / tile_m, -y * w.height / 2 / tile_m);
  }
  shape.index = {0, 1, 2, 0, 2, 3};
  out.node("wall", {{"mesh", out.mesh("wall", out.primitive(shape), material)}});
  // It deepens while the second shot looks at it, and flattens.
  const std::array times{0.0, 5.2, 6.6, 7.2, 8.4, 9.5, 11.0, 13.0, 15.0};
  const std::array depths{0.0, 0.0, 0.2, 0.2, 0.02, 0.12, 0.17, 0.03, 0.15};
  out.animate_pointer(fmt::format("/materials/{}/extensions/CANDELA_relief/depth", material), "LINEAR", times, depths,
                      1);
}

void add_water(GlbWriter& out, uint64_t seed) {
  constexpr double tile_m = 2.5;
  const TileMaps ripples = bake_tile(256, tile_m, [seed](double u, double v) {
    TilePoint p;
    p.height_m = 0.006 * tiling_octaves(u, v, 7, 3, seed + 40);
    return p;
  });
  json water = pbr({0.006, 0.012, 0.012, 1}, 0, 0.04);
  water["normalTexture"] = {{"index", out.texture("ripples", ripples.normal, trilinear())}, {"scale", 0.5}};
  const int material = out.material("water", water);
  Shape shape;
  const glm::dvec2 low(-4.4, -6.2), high(5.0, 1.6);
  for (int k = 0; k < 4; ++k) {
    const glm::dvec2 at(k == 1 || k == 2 ? high.x : low.x, k >= 2 ? low.y : high.y);
    shape.position.emplace_back(at.x, water_m, at.y);
    shape.normal.emplace_back(0, 1, 0);
    shape.uv.push_back(at / tile_m);
  }
  shape.index = {0, 1, 2, 0, 2, 3};
  out.node("pool", {{"mesh", out.mesh("pool", out.primitive(shape), material)}});
}

glm::dvec3 rock_color(glm::dvec3 p, glm::dvec3 normal) {
  // What lies deep between folds is darker; layers of stone, and lime where water runs down.
  double open = 1;
  for (const double d : {0.25, 0.7}) open = std::min(open, std::clamp(-air(p + normal * d) / d, 0.0, 1.0));
  const double layer = noise3({p.x * 0.3, p.y * 1.7 + 0.4 * noise3(p * 0.5, 5), p.z * 0.3}, 6),
               broad = fbm3(p * 0.4, 3, 7);
  const glm::dvec3 warm(1.12, 0.94, 0.78), cool(0.82, 0.9, 0.96);
  return glm::mix(cool, warm, std::clamp(0.5 + 0.9 * broad + 0.35 * layer, 0.0, 1.0)) * (0.8 + 0.25 * layer) *
         (0.35 + 0.65 * open);
}

}  // namespace

json trilinear() { return {{"magFilter", 9729}, {"minFilter", 9987}}; }

double floor_height(glm::dvec2 at) {
  const glm::dvec3 p(at.x, 0, at.y);
  const double to_island = glm::length(at - island) + 0.2 * fbm3(p * 1.6, 2, 72);
  const double to_ledge = glm::length((at - ledge) / glm::dvec2(1.15, 1)) + 0.35 * fbm3(p * 0.9, 2, 73);
  return 0.22 * fbm3(p * 0.45, 3, 70) + 0.05 * fbm3(p * 2.5, 3, 74) - 0.75 * pool_at(at) +
         1.05 * (1 - smooth_step(0.45, 1.15, to_island)) + 0.95 * (1 - smooth_step(2.15, 3.4, to_ledge));
}

double air(glm::dvec3 p) {
  const glm::dvec3 q = p + 0.35 * glm::dvec3(noise3(p * 0.6, 1), 0.5 * noise3(p * 0.6, 2), noise3(p * 0.6, 3));
  double d = to_ellipsoid(q, {0, 2.2, -3}, {6.8, 4.4, 6.6});
  d = smooth_min(d, to_ellipsoid(q, {-4.4, 2.9, -6}, {3.6, 3.6, 3.6}), 1.2);
  d = smooth_min(d, to_ellipsoid(q, {4.1, 2.2, -7.3}, {2.9, 3, 3}), 1);
  d = smooth_min(d, to_round_cone(q, {1.7, 1.7, 13}, 1.9, {0.8, 1.8, 4}, 2.2), 1.2);
  d = smooth_min(d, to_round_cone(q, {0.8, 5, -1.0}, 1.6, {1.6, 10.6, 1.0}, 2.1), 1.2);
  d += 0.45 * fbm3(p * 0.55, 3, 10) + 0.3 * (0.55 - ridged3(p * glm::dvec3(0.8, 1.5, 0.8), 3, 11)) +
       0.05 * noise3(p * 3.1, 14);
  // The light from above comes in by what no fold of the rock closes.
  d = smooth_min(d, to_round_cone(p, shaft_top + glm::dvec3(0.1, 1.0, 0.3), 1.15, {0.85, 4.6, -0.9}, 1.2), 0.5);
  // Columns from floor to ceiling.
  constexpr std::array<glm::dvec3, 6> columns{
      {{-2.9, 0.36, 1.5}, {3.7, 0.42, 0.5}, {-6.0, 0.5, -2.2}, {1.5, 0.55, -9.3}, {-1.2, 0.3, -8.6}, {5.6, 0.4, -3.9}}};
  for (const glm::dvec3& c : columns) {
    const double away = glm::length(glm::dvec2(q.x - c.x, q.z - c.z));
    if (away - (2.5 * c.y + 0.15) > 0.5 - d) continue;  // no part in the blend
    const double up = std::clamp(p.y - 2.1, -3.0, 3.5);
    const double radius = c.y * (0.8 + 0.11 * up * up) * (1 + 0.14 * noise3({p.y * 2.2, c.x, c.z}, 20)) +
                          0.12 * fbm3(p * glm::dvec3(3, 0.8, 3), 2, 21);
    d = smooth_max(d, radius - away, 0.5);
  }
  constexpr double highest_floor_m = 2;
  if (d > highest_floor_m - p.y + 0.35) return d;
  return smooth_max(d, floor_height({p.x, p.z}) - p.y, 0.35);
}

void add_rock(GlbWriter& out, uint64_t seed) {
  constexpr double cell_m = 0.3, tile_m = 3, chunk_m = 5;
  const int rock = out.material(
      "rock", textured_material(out, "rock",
                                bake_tile(512, tile_m, [seed](double u, double v) { return rock_point(u, v, seed); })));
  const ImplicitMesh hall =
      mesh_implicit([](glm::dvec3 p) { return -air(p); }, {-9.6, -2, -12.5}, {9.6, 13.8, 16}, cell_m, 2.2);
  // In pieces, so that shadow maps draw what lies before them.
  std::map<std::pair<int, int>, ImplicitMesh> pieces;
  for (size_t i = 0; i < hall.index.size(); i += 3) {
    const glm::dvec3 p = hall.position[hall.index[i]];
    ImplicitMesh& piece = pieces[{int(std::floor(p.x / chunk_m)), int(std::floor(p.z / chunk_m))}];
    for (size_t k = 0; k < 3; ++k) piece.index.push_back(hall.index[i + k]);
  }
  for (auto& [place, piece] : pieces) {
    piece.position = hall.position, piece.normal = hall.normal;
    const Shape shape =
        textured(piece, {[](glm::dvec3, glm::dvec3 n) { return box_group(n); },
                         [](glm::dvec3 at, glm::dvec3, int group) { return box_uv(at, group) / tile_m; }, rock_color});
    out.node("hall", {{"mesh", out.mesh("hall", out.primitive(shape), rock)}});
  }
  add_stones(out, rock);
  add_water(out, seed);
  add_wall(out, seed);
}

}  // namespace candela::cave
