#include "scene/gradient_sky.h"

#include <cmath>
#include <cstring>
#include <numbers>

namespace candela {

double gradient_share(int band, double exponent, double sine) {
  const double away = std::pow(std::min(std::abs(sine), 1.0), exponent);
  if (band == 1) return 1 - away;
  return (band == 0) == (sine > 0) ? away : 0;
}

DecodedImage gradient_image(int band, double exponent, int width, int height) {
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 3, {}};
  image.pixels.resize(size_t(width) * size_t(height) * 16);
  constexpr int parts = 16;
  for (int y = 0; y < height; ++y) {
    double sum = 0;
    for (int i = 0; i < parts; ++i)
      sum += gradient_share(band, exponent, std::cos(std::numbers::pi * (y + (i + 0.5) / parts) / height));
    const float fraction = float(sum / parts);
    const glm::vec4 texel(fraction, fraction, fraction, 1);
    for (int x = 0; x < width; ++x)
      std::memcpy(image.pixels.data() + (size_t(y) * size_t(width) + size_t(x)) * 16, &texel, 16);
  }
  return image;
}

}  // namespace candela
