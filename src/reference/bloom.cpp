#include "reference/bloom.h"

#include <algorithm>
#include <cmath>

namespace candela::reference {
namespace {

// One axis: `stride` leads from a texel to the next, `lines` of `length` texels begin `line_stride` apart.
std::vector<glm::dvec3> convolved(const std::vector<glm::dvec3>& from, int length, int lines, int stride,
                                  int line_stride, double variance_px2) {
  const int radius = int(std::ceil(6 * std::sqrt(variance_px2)));
  std::vector<double> kernel(size_t(radius) + 1);
  double sum = 0;
  for (int i = 0; i <= radius; ++i) {
    kernel[size_t(i)] = std::exp(-double(i) * i / (2 * variance_px2));
    sum += kernel[size_t(i)] * (i > 0 ? 2 : 1);
  }
  std::vector<glm::dvec3> to(from.size());
  for (int line = 0; line < lines; ++line)
    for (int x = 0; x < length; ++x) {
      glm::dvec3 value(0);
      for (int i = -radius; i <= radius; ++i)
        value += kernel[size_t(std::abs(i))] *
                 from[size_t(line) * size_t(line_stride) + size_t(std::clamp(x + i, 0, length - 1)) * size_t(stride)];
      to[size_t(line) * size_t(line_stride) + size_t(x) * size_t(stride)] = value / sum;
    }
  return to;
}

}  // namespace

glm::dvec3 bloom_bright(glm::dvec3 c, double threshold, double knee) {
  for (int i = 0; i < 3; ++i) c[i] = std::isfinite(c[i]) ? std::max(c[i], 0.0) : 0.0;
  const double brightest = std::max({c.x, c.y, c.z});
  if (threshold <= 0 || brightest <= 0) return c;
  double above = std::max(brightest - threshold, 0.0);
  if (knee > 0 && std::abs(brightest - threshold) < knee)
    above = (brightest - threshold + knee) * (brightest - threshold + knee) / (4 * knee);
  return c * (above / brightest);
}

std::vector<glm::dvec3> bloom_glow(const std::vector<glm::dvec3>& picture, int width, int height, const Bloom& look,
                                   double exposure) {
  std::vector<glm::dvec3> bright(picture.size()), glow(picture.size(), glm::dvec3(0));
  for (size_t i = 0; i < picture.size(); ++i)
    bright[i] = bloom_bright(picture[i], look.threshold / exposure, look.knee / exposure);
  double weights = 0;
  for (size_t k = 0; k < look.weights.size(); ++k) {
    const double variance = Bloom::variance_px2(k);
    const auto rows = convolved(bright, width, height, 1, width, variance);
    const auto level = convolved(rows, height, width, width, 1, variance);
    for (size_t i = 0; i < glow.size(); ++i) glow[i] += look.weights[k] * level[i];
    weights += look.weights[k];
  }
  for (glm::dvec3& g : glow) g /= weights;
  return glow;
}

std::vector<glm::dvec3> bloomed(const std::vector<glm::dvec3>& picture, const std::vector<glm::dvec3>& glow,
                                const Bloom& look, double exposure) {
  std::vector<glm::dvec3> out(picture.size());
  for (size_t i = 0; i < picture.size(); ++i) {
    out[i] = picture[i] + look.strength * glow[i];
    if (look.keeps) out[i] -= look.strength * bloom_bright(picture[i], look.threshold / exposure, look.knee / exposure);
  }
  return out;
}

}  // namespace candela::reference
