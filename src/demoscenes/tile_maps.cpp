#include "demoscenes/tile_maps.h"

#include <algorithm>
#include <cmath>

#include "base/rng.h"
#include "testscenes/procedural_textures.h"

namespace candela {
namespace {

double mix(double a, double b, double t) { return a + (b - a) * t; }

// A number in [0,1) for a stone of a pattern.
double stone_number(int x, int y, uint64_t seed) {
  Rng rng(seed * 0x100000001b3u + uint64_t(uint32_t(x)) * 7919 + uint32_t(y));
  rng.next();
  return rng.uniform();
}

}  // namespace

double srgb_of(double linear) {
  return linear <= 0.0031308 ? 12.92 * std::max(linear, 0.0) : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
glm::dvec3 srgb_of(glm::dvec3 c) { return {srgb_of(c.x), srgb_of(c.y), srgb_of(c.z)}; }

double tiling_octaves(double u, double v, int cells, int octaves, uint64_t seed) {
  double sum = 0, weight = 0.5, whole = 0;
  for (int i = 0; i < octaves; ++i, weight /= 2, cells *= 2) {
    sum += weight * tiling_noise(u, v, cells, seed + uint64_t(i) * 101);
    whole += weight;
  }
  return sum / whole;
}

TileMaps bake_tile(int size, double side_m, const std::function<TilePoint(double, double)>& point) {
  std::vector<TilePoint> points;
  points.reserve(size_t(size) * size_t(size));
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) points.push_back(point((x + 0.5) / size, (y + 0.5) / size));
  const auto at = [&](int x, int y) -> const TilePoint& {
    return points[size_t((y + size) % size) * size_t(size) + size_t((x + size) % size)];
  };
  const auto pixels = [&](const auto& value) {
    return png_from(size, size, 3, [&](double u, double v) { return value(int(u * size), int(v * size)); });
  };
  const double two_texels_m = 2 * side_m / size;
  TileMaps maps;
  maps.color = pixels([&](int x, int y) { return glm::dvec4(srgb_of(at(x, y).color), 1); });
  maps.normal = pixels([&](int x, int y) {
    // v grows downwards in the image while +Y of the tangent space points up.
    const double du = at(x + 1, y).height_m - at(x - 1, y).height_m, dv = at(x, y + 1).height_m - at(x, y - 1).height_m;
    return glm::dvec4(glm::normalize(glm::dvec3(-du, dv, two_texels_m)) * 0.5 + 0.5, 1);
  });
  maps.roughness = pixels([&](int x, int y) { return glm::dvec4(1, at(x, y).roughness, at(x, y).metallic, 1); });
  return maps;
}

TilePoint asphalt_point(double u, double v, uint64_t seed) {
  const double grain = tiling_noise(u, v, 256, seed), coarse = tiling_noise(u, v, 128, seed + 1);
  const double patches = tiling_octaves(u, v, 4, 4, seed + 2);
  // Cracks run where two slow noises are equal.
  const double apart = std::abs(tiling_octaves(u, v, 3, 4, seed + 3) - 0.5);
  const double crack = (1 - smooth_step(0.0, 0.003, apart)) * smooth_step(0.55, 0.65, patches);
  TilePoint p;
  const double grey = (0.022 + 0.03 * grain * coarse + 0.014 * patches) * (1 - 0.6 * crack);
  p.color = glm::dvec3(1, 1.01, 1.04) * grey;
  p.height_m = 0.0009 * (0.6 * grain + 0.4 * coarse) - 0.0012 * crack;
  p.roughness = mix(0.62, 0.75, grain);
  return p;
}

double puddle_roughness(double u, double v, uint64_t seed) {
  const double wet = tiling_octaves(u, v, 9, 4, seed), streak = tiling_noise(u, v, 24, seed + 7);
  const double standing = smooth_step(0.5, 0.57, wet);
  return mix(mix(0.19, 0.38, streak), 0.06, standing);
}

TilePoint pavement_point(double u, double v, uint64_t seed) {
  constexpr int slabs = 4;
  const double y = v * slabs, row = std::floor(y), x = u * slabs + 0.5 * std::fmod(row, 2), column = std::floor(x);
  const double fx = x - column, fy = y - row;
  const double edge = std::min({fx, 1 - fx, fy, 1 - fy});
  const double joint = 1 - smooth_step(0.012, 0.026, edge);
  const int i = (int(column) % slabs + slabs) % slabs, j = int(row);
  const double shade = stone_number(i, j, seed), grain = tiling_noise(u, v, 200, seed + 1);
  const double dirt = tiling_octaves(u, v, 5, 4, seed + 2), wet = tiling_octaves(u, v, 4, 3, seed + 3);
  TilePoint p;
  const double grey = (0.16 + 0.1 * shade + 0.05 * (grain - 0.5)) * mix(0.7, 1.1, dirt) * (1 - 0.75 * joint);
  p.color = glm::dvec3(1.03, 1, 0.95) * grey;
  p.height_m = 0.0006 * grain + 0.0015 * shade - 0.006 * joint;
  p.roughness = mix(0.75, 0.26, smooth_step(0.42, 0.62, wet));
  return p;
}

TilePoint brick_point(double u, double v, uint64_t seed) {
  constexpr int courses = 24, bricks = 8;
  const double y = v * courses, row = std::floor(y), x = u * bricks + 0.5 * std::fmod(row, 2), column = std::floor(x);
  const double fx = (x - column) * 0.24, fy = (y - row) * 0.08;  // metres within a brick and its joint
  const double edge = std::min({fx, 0.24 - fx, fy, 0.08 - fy});
  const double joint = 1 - smooth_step(0.004, 0.008, edge);
  const int i = (int(column) % bricks + bricks) % bricks, j = int(row);
  const double shade = stone_number(i, j, seed), warm = stone_number(i, j, seed + 9);
  const double grain = tiling_noise(u, v, 180, seed + 1), soot = tiling_octaves(u, v, 3, 4, seed + 2);
  TilePoint p;
  const glm::dvec3 brick = glm::dvec3(0.40, 0.40 * mix(0.72, 0.9, warm), 0.40 * mix(0.6, 0.8, warm)) *
                           mix(0.6, 1.25, shade) * mix(0.85, 1.15, grain);
  p.color = glm::mix(brick, glm::dvec3(0.30, 0.29, 0.27), joint) * mix(0.65, 1.1, soot);
  p.height_m = 0.002 * grain + 0.003 * shade - 0.01 * joint;
  p.roughness = mix(0.72, 0.88, grain);
  return p;
}

TilePoint plaster_point(double u, double v, uint64_t seed) {
  const double stain = tiling_octaves(u, v, 3, 5, seed), grain = tiling_noise(u, v, 160, seed + 1);
  TilePoint p;
  p.color = glm::dvec3(0.62 * mix(0.72, 1.1, stain) * mix(0.94, 1.06, grain));
  p.height_m = 0.0015 * grain + 0.004 * stain;
  p.roughness = mix(0.7, 0.85, grain);
  return p;
}

TilePoint metal_point(double u, double v, uint64_t seed) {
  const double wear = tiling_octaves(u, v, 6, 4, seed), grain = tiling_noise(u, v, 64, seed + 1);
  TilePoint p;
  p.color = glm::dvec3(0.5 * mix(0.8, 1.1, wear));
  p.height_m = 0.0004 * grain;
  p.roughness = mix(0.28, 0.52, wear);
  p.metallic = 0.4;
  return p;
}

}  // namespace candela
