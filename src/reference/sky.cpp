#include "reference/sky.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/rng.h"
#include "image/sky_texel.h"
#include "reference/brdf.h"
#include "scene/environment.h"
#include "scene/studio.h"

namespace candela::reference {
namespace {

using std::numbers::pi;

// Where u falls in a cumulative distribution, and how far inside that cell.
struct Place {
  int index;
  double fraction;
};
Place place_of(const double* end, int count, double u) {
  const int index = int(std::min<std::ptrdiff_t>(std::upper_bound(end, end + count, u) - end, count - 1));
  const double low = index > 0 ? end[index - 1] : 0, width = end[index] - low;
  return {index, width > 0 ? std::clamp((u - low) / width, 0.0, 1.0) : 0.5};
}

glm::vec3 rgb_of(const SkyTexel& t) { return {t[0], t[1], t[2]}; }

// Turns weights into cumulative shares. Without any weight all cells are alike.
void accumulate(double* weights, int count) {
  double total = 0;
  for (int i = 0; i < count; ++i) total += weights[i];
  double sum = 0;
  for (int i = 0; i < count; ++i) {
    sum += total > 0 ? weights[i] / total : 1.0 / count;
    weights[i] = sum;
  }
  // Rounding must not leave a cell without weight beyond the end that a number close to 1 could fall into.
  int last = count - 1;
  while (last > 0 && weights[last] == weights[last - 1]) --last;
  for (int i = last; i < count; ++i) weights[i] = 1;
}

}  // namespace

Sky::Sky(const DecodedImage& image, double turn_rad, double times)
    : kind_(Kind::image),
      turn_cos_(std::cos(turn_rad)),
      turn_sin_(std::sin(turn_rad)),
      times_(times),
      image_width_(image.width),
      image_height_(image.height) {
  texels_.resize(size_t(image.width) * size_t(image.height));
  for (size_t i = 0; i < texels_.size(); ++i) texels_[i] = rgb_of(sky_texel(image, i));
  make_distribution(image.width, image.height);
}

Sky Sky::sum(std::span<const Part> parts, const std::optional<SkyGradient>& gradient, double gradient_weight,
             double turn_rad, double times) {
  Sky sky;
  sky.kind_ = Kind::sum;
  sky.turn_cos_ = std::cos(turn_rad), sky.turn_sin_ = std::sin(turn_rad), sky.times_ = times;
  sky.gradient_ = gradient, sky.gradient_weight_ = gradient_weight;
  if (!parts.empty()) {
    sky.image_width_ = parts[0].equirect->width, sky.image_height_ = parts[0].equirect->height;
    std::vector<glm::dvec3> sums(size_t(sky.image_width_) * size_t(sky.image_height_));
    for (const Part& part : parts)
      for (size_t i = 0; i < sums.size(); ++i) {
        sums[i] += part.weight * glm::dvec3(rgb_of(sky_texel(*part.equirect, i)));
      }
    sky.texels_.assign(sums.begin(), sums.end());
  }
  sky.make_distribution(parts.empty() ? 1 : sky.image_width_, parts.empty() ? 256 : sky.image_height_);
  return sky;
}

Sky Sky::neutral() {
  Sky sky;
  sky.kind_ = Kind::linear;
  sky.constant_ = glm::dvec3(0.45);
  sky.slope_ = glm::dvec3(0.25);
  sky.make_distribution(1, 32);
  return sky;
}

Sky Sky::studio(double turn_rad, double times) {
  Sky sky;
  sky.kind_ = Kind::studio;
  sky.turn_cos_ = std::cos(turn_rad), sky.turn_sin_ = std::sin(turn_rad), sky.times_ = times;
  sky.make_distribution(256, 128);
  return sky;
}

Sky Sky::constant(glm::dvec3 radiance) {
  Sky sky;
  sky.kind_ = Kind::linear;
  sky.constant_ = radiance;
  sky.make_distribution(1, 1);
  return sky;
}

glm::dvec3 Sky::texel(int x, int y) const {
  x = (x % image_width_ + image_width_) % image_width_;
  y = std::clamp(y, 0, image_height_ - 1);
  return texels_[size_t(y) * size_t(image_width_) + size_t(x)];
}

glm::dvec3 Sky::in_image(glm::dvec3 d) const {
  return {turn_cos_ * d.x - turn_sin_ * d.z, d.y, turn_sin_ * d.x + turn_cos_ * d.z};
}

glm::dvec3 Sky::radiance(glm::dvec3 d) const {
  if (kind_ == Kind::none) return glm::dvec3(0);
  if (kind_ == Kind::linear) return constant_ + slope_ * d.y;
  if (kind_ == Kind::studio) return glm::dvec3(times_ * studio_radiance(in_image(d)));
  const glm::dvec3 gradient = times_ * gradient_at(d.y);
  if (texels_.empty()) return gradient;
  const glm::dvec3 image = times_ * bilinear(d, [&](int x, int y) { return texel(x, y); });
  return gradient_ ? gradient + image : image;
}

glm::dvec3 Sky::seen(glm::dvec3 d) const {
  glm::dvec3 seen = radiance(d);
  if (shown_.empty()) return seen;
  seen += times_ * bilinear(d, [&](int x, int y) {
            x = (x % image_width_ + image_width_) % image_width_, y = std::clamp(y, 0, image_height_ - 1);
            const auto more = shown_.find(uint32_t(y) * uint32_t(image_width_) + uint32_t(x));
            return more == shown_.end() ? glm::dvec3(0) : more->second;
          });
  return seen;
}

// Of texels of the image, about a direction of the world.
template <class Texel>
glm::dvec3 Sky::bilinear(glm::dvec3 d, Texel texel) const {
  d = in_image(d);
  const double x = (std::atan2(d.z, d.x) / (2 * pi) + 0.5) * image_width_ - 0.5;
  const double y = std::acos(std::clamp(d.y, -1.0, 1.0)) / pi * image_height_ - 0.5;
  const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
  const double fx = x - x0, fy = y - y0;
  return glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), fx),
                  glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), fx), fy);
}

glm::dvec3 Sky::gradient_at(double sine) const {
  if (!gradient_) return glm::dvec3(0);
  const SkyGradient& g = *gradient_;
  const double fraction = std::pow(std::min(std::abs(sine), 1.0), g.exponent);
  return gradient_weight_ * glm::mix(g.horizon, sine > 0 ? g.zenith : g.ground, fraction);
}

glm::dvec3 Sky::blurred(glm::dvec3 d, double deviation_rad) const {
  const double kappa = 1 / (deviation_rad * deviation_rad);
  const glm::dvec3 aside = std::abs(d.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(aside, d)), y = glm::cross(d, x);
  uint64_t state = 0x9e3779b97f4a7c15u;
  for (int k = 0; k < 3; ++k) state = (state ^ std::bit_cast<uint64_t>(d[k])) * 0xd6e8feb86659fd93u + (state >> 29);
  Rng rng(state);
  constexpr int directions = 16;
  glm::dvec3 sum(0);
  for (int i = 0; i < directions; ++i) {
    const double u = (i + rng.uniform()) / directions, phi = 2 * pi * rng.uniform();
    const double less = -std::log1p(-(1 - u) * -std::expm1(-2 * kappa)) / kappa;  // 1 - cos(angle)
    const double across = std::sqrt(std::max(less * (2 - less), 0.0));
    sum += seen(glm::normalize((1 - less) * d + across * (std::cos(phi) * x + std::sin(phi) * y)));
  }
  return sum / double(directions);
}

double Sky::solid_angle(int row) const {
  return 2 * pi / width_ * (std::cos(pi * row / height_) - std::cos(pi * (row + 1) / height_));
}

void Sky::make_distribution(int width, int height) {
  width_ = width, height_ = height;
  row_end_.resize(size_t(height));
  column_end_.resize(size_t(width) * size_t(height));
  for (int y = 0; y < height; ++y) {
    double* row = column_end_.data() + size_t(y) * size_t(width);
    double sum = 0;
    for (int x = 0; x < width; ++x) {
      glm::dvec3 mean(0);
      if (kind_ == Kind::linear) {
        mean = radiance({0, std::cos(pi * (y + 0.5) / height), 0});
      } else if (kind_ == Kind::studio) {
        constexpr int parts = 3;
        for (int i = 0; i < parts * parts; ++i)
          mean += studio_radiance(
              equirect_direction((x + (i % parts + 0.5) / parts) / width, (y + (i / parts + 0.5) / parts) / height));
      } else if (texels_.empty()) {
        mean = gradient_at(std::cos(pi * (y + 0.5) / height));
      } else {
        mean = gradient_at(std::cos(pi * (y + 0.5) / height));
        // The mean of the bilinear image over the texel: wherever the image is not black, the weight is not 0.
        constexpr double weight[3] = {0.125, 0.75, 0.125};
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) mean += weight[i + 1] * weight[j + 1] * texel(x + i, y + j);
      }
      row[x] = std::max(luminance(mean), 0.0) * solid_angle(y);
      sum += row[x];
    }
    row_end_[size_t(y)] = sum;
    accumulate(row, width);
  }
  accumulate(row_end_.data(), height);
}

glm::ivec2 Sky::cell_of(glm::dvec3 d) const {
  d = in_image(d);
  const double u = std::atan2(d.z, d.x) / (2 * pi) + 0.5, v = std::acos(std::clamp(d.y, -1.0, 1.0)) / pi;
  return {std::clamp(int(u * width_), 0, width_ - 1), std::clamp(int(v * height_), 0, height_ - 1)};
}

double Sky::pdf(glm::dvec3 d) const {
  if (kind_ == Kind::none) return 0;
  const glm::ivec2 c = cell_of(d);
  const double* row = column_end_.data() + size_t(c.y) * size_t(width_);
  const double in_row = row[c.x] - (c.x > 0 ? row[c.x - 1] : 0);
  const double of_rows = row_end_[size_t(c.y)] - (c.y > 0 ? row_end_[size_t(c.y) - 1] : 0);
  return in_row * of_rows / solid_angle(c.y);
}

Sky::Choice Sky::sample(glm::dvec2 u) const {
  if (kind_ == Kind::none) return {};
  const Place row = place_of(row_end_.data(), height_, u.y);
  const Place column = place_of(column_end_.data() + size_t(row.index) * size_t(width_), width_, u.x);
  const double top = std::cos(pi * row.index / height_), bottom = std::cos(pi * (row.index + 1) / height_);
  const double y = glm::mix(top, bottom, row.fraction),
               longitude = 2 * pi * ((column.index + column.fraction) / width_ - 0.5);
  const double r = std::sqrt(std::max(1 - y * y, 0.0));
  const double x = r * std::cos(longitude), z = r * std::sin(longitude);
  const glm::dvec3 direction(turn_cos_ * x + turn_sin_ * z, y, turn_cos_ * z - turn_sin_ * x);
  return {direction, pdf(direction)};
}

}  // namespace candela::reference
