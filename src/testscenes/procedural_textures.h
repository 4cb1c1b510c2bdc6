#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace candela {

// A PNG of 8 bits a channel whose pixel (x, y), row 0 on top, is color(u, v) in [0,1] at the pixel's centre; channels 3
// or 4.
std::vector<std::byte> png_from(int width, int height, int channels,
                                const std::function<glm::dvec4(double u, double v)>& color);

// A tangent-space normal map of a height field that repeats over [0,1]^2 (glTF convention: +Y is up in the image).
std::vector<std::byte> normal_map_from(int size, double strength,
                                       const std::function<double(double u, double v)>& height);

// Smooth value noise in [0,1] with `cells` cells a side, repeating over [0,1]^2.
double tiling_noise(double u, double v, int cells, uint64_t seed);
double smooth_step(double low, double high, double x);

}  // namespace candela
