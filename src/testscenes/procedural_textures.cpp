#include "testscenes/procedural_textures.h"

#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/rng.h"

namespace candela {

namespace {

double lattice(int x, int y, int cells, uint64_t seed) {
  const auto wrap = [cells](int i) { return uint64_t(((i % cells) + cells) % cells); };
  Rng rng(seed * 0x100000001b3u + wrap(x) * 8191 + wrap(y));
  rng.next();
  return rng.uniform();
}

}  // namespace

std::vector<std::byte> png_from(int width, int height, int channels,
                                const std::function<glm::dvec4(double, double)>& color) {
  std::vector<uint8_t> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec4 c = color((x + 0.5) / width, (y + 0.5) / height);
      for (int i = 0; i < channels; ++i) pixels.push_back(uint8_t(std::lround(std::clamp(c[i], 0.0, 1.0) * 255)));
    }
  std::vector<std::byte> out;
  const auto append = [](void* context, void* data, int size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    static_cast<std::vector<std::byte>*>(context)->insert(static_cast<std::vector<std::byte>*>(context)->end(), bytes,
                                                          bytes + size);
  };
  CHECK(stbi_write_png_to_func(append, &out, width, height, channels, pixels.data(), width * channels) != 0);
  return out;
}

std::vector<std::byte> normal_map_from(int size, double strength, const std::function<double(double, double)>& height) {
  const double step = 1.0 / size;
  return png_from(size, size, 3, [&](double u, double v) {
    const double du = height(u + step, v) - height(u - step, v), dv = height(u, v + step) - height(u, v - step);
    // v grows downwards in the image while +Y of the tangent space points up.
    const glm::dvec3 n = glm::normalize(glm::dvec3(-du * strength, dv * strength, 2));
    return glm::dvec4(n * 0.5 + 0.5, 1);
  });
}

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double tiling_noise(double u, double v, int cells, uint64_t seed) {
  const double x = u * cells, y = v * cells, fx = std::floor(x), fy = std::floor(y);
  const double s = smooth_step(0, 1, x - fx), t = smooth_step(0, 1, y - fy);
  const int i = int(fx), j = int(fy);
  const double top = lattice(i, j, cells, seed) * (1 - s) + lattice(i + 1, j, cells, seed) * s;
  const double bottom = lattice(i, j + 1, cells, seed) * (1 - s) + lattice(i + 1, j + 1, cells, seed) * s;
  return top * (1 - t) + bottom * t;
}

}  // namespace candela
