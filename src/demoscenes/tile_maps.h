#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace candela {

// One place of a material that repeats over [0,1]^2. Colours are linear.
struct TilePoint {
  glm::dvec3 color{0.5};
  double height_m = 0;
  double roughness = 0.8, metallic = 0;
};

// The three textures of a material as PNG: base colour (sRGB), tangent-space normals from the heights, and roughness
// (green) with metallic (blue).
struct TileMaps {
  std::vector<std::byte> color, normal, roughness;
};
// `side_m` is how many metres the square covers; heights are differenced across its edges, so that it repeats.
TileMaps bake_tile(int size_px, double side_m, const std::function<TilePoint(double u, double v)>& point);

// Octaves of tiling_noise, each twice as fine and half as strong as the one before, in [0,1].
double tiling_octaves(double u, double v, int cells, int octaves, uint64_t seed);

// Linear to sRGB, a channel.
double srgb_of(double linear);
glm::dvec3 srgb_of(glm::dvec3 linear);

// The street's materials. `seed` moves their noise.
TilePoint asphalt_point(double u, double v, uint64_t seed);   // 4 m
double puddle_roughness(double u, double v, uint64_t seed);   // of wet asphalt, over 24 m: low where water stands
TilePoint pavement_point(double u, double v, uint64_t seed);  // slabs of 0.6 by 0.6 m over 2.4 m
TilePoint brick_point(double u, double v, uint64_t seed);     // 1.92 m, courses of 80 mm
TilePoint plaster_point(double u, double v, uint64_t seed);   // 3 m
TilePoint metal_point(double u, double v, uint64_t seed);     // painted cast iron, 1 m

}  // namespace candela
