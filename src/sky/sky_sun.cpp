#include "sky/sky_sun.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "scene/environment.h"

namespace candela {
namespace {

using std::numbers::pi;

// A sun is at most this wide, or where texels are wide little more than one of them.
constexpr double most_radius_rad = 2 * pi / 180, most_radius_texels = 1.2, widest_rad = 7 * pi / 180;
// Measured over the skies of docs/understanding/image-based-light.md: suns, the moon and a lamp that outshines its room
// have shares from 0.5 and contrasts from 1900, windows and lamps among others shares below 0.02.
constexpr double least_share = 0.1, least_contrast = 30, least_contrast_asked_for = 2;
constexpr double search_rad = 5 * pi / 180, search_texels = 2;  // about the brightest texel
constexpr double reach_radii = 3, reach_texels = 1.5;           // of what is taken

double luminance(glm::dvec3 c) { return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)); }

class Texels {
 public:
  explicit Texels(const DecodedImage& image) : image_(image) {
    for (int x = 0; x < width(); ++x) {
      const double longitude = ((x + 0.5) / width() - 0.5) * 2 * pi;
      columns_.emplace_back(std::cos(longitude), std::sin(longitude));
    }
    for (int y = 0; y < height(); ++y) {
      const double polar = (y + 0.5) / height() * pi;
      rows_.emplace_back(std::cos(polar), std::sin(polar));
    }
  }
  int width() const { return image_.width; }
  int height() const { return image_.height; }
  double row_rad() const { return pi / height(); }
  uint32_t place(int x, int y) const { return uint32_t(y) * uint32_t(width()) + uint32_t(x); }
  glm::dvec3 at(int x, int y) const {
    glm::vec3 t;
    std::memcpy(&t, image_.pixels.data() + size_t(place(x, y)) * 16, 12);
    return t;
  }
  double solid_angle(int y) const {
    return 2 * pi / width() * (std::cos(row_rad() * y) - std::cos(row_rad() * (y + 1)));
  }
  // What equirect_direction() gives.
  glm::dvec3 direction(int x, int y) const {
    const glm::dvec2 column = columns_[size_t(x)], row = rows_[size_t(y)];
    return {row.y * column.x, row.x, row.y * column.y};
  }
  // visit(x, y, direction) of the texels whose middles lie within the angle, across the seam and the poles.
  template <class Visit>
  void about(glm::dvec3 middle, double angle, Visit visit) const {
    const double polar = std::acos(std::clamp(middle.y, -1.0, 1.0)), cosine = std::cos(angle);
    const int first = std::max(int((polar - angle) / row_rad()) - 1, 0),
              last = std::min(int((polar + angle) / row_rad()) + 1, height() - 1);
    for (int y = first; y <= last; ++y)
      for (int x = 0; x < width(); ++x)
        if (const glm::dvec3 d = direction(x, y); glm::dot(d, middle) >= cosine) visit(x, y, d);
  }

 private:
  const DecodedImage& image_;
  std::vector<glm::dvec2> columns_, rows_;  // cosines and sines of longitude and polar angle
};

glm::dvec3 brightest(const Texels& texels) {
  struct Best {
    double light = 0;
    int x = 0;
  };
  std::vector<Best> rows(size_t(texels.height()));
  tbb::parallel_for(0, texels.height(), [&](int y) {
    for (int x = 0; x < texels.width(); ++x)
      if (const double light = luminance(texels.at(x, y)); light > rows[size_t(y)].light) rows[size_t(y)] = {light, x};
  });
  const auto best = std::ranges::max_element(rows, {}, &Best::light);
  return best->light > 0 ? texels.direction(best->x, int(best - rows.begin())) : glm::dvec3(0);
}

// Mean radiance between the angle and twice it.
glm::dvec3 mean_around(const Texels& texels, glm::dvec3 middle, double angle) {
  glm::dvec3 sum(0);
  double all = 0;
  const double cosine = std::cos(angle);
  texels.about(middle, 2 * angle, [&](int x, int y, glm::dvec3 d) {
    if (glm::dot(d, middle) >= cosine) return;
    sum += texels.solid_angle(y) * texels.at(x, y), all += texels.solid_angle(y);
  });
  return all > 0 ? sum / all : glm::dvec3(0);
}

// What lies within the reach about the middle and is brighter than the surroundings: its middle and spread.
void measure(const Texels& texels, SkySun& sun) {
  sun.around = mean_around(texels, sun.direction, sun.reach_rad);
  glm::dvec3 sum(0);
  double weight = 0;
  sun.illuminance = glm::dvec3(0);
  texels.about(sun.direction, sun.reach_rad, [&](int x, int y, glm::dvec3 d) {
    const glm::dvec3 over = texels.solid_angle(y) * glm::max(texels.at(x, y) - sun.around, glm::dvec3(0));
    sun.illuminance += over;
    sum += luminance(over) * d, weight += luminance(over);
  });
  const double length = glm::length(sum);
  if (!(length > 0)) return;
  sun.direction = sum / length;
  // A disc's mean square angle is half the square of its radius. A texel seen bilinearly is a tent, of a sixth of its
  // square along each axis.
  const double across = std::sqrt(std::max(1 - sun.direction.y * sun.direction.y, 0.0)) * 2 * pi / texels.width();
  const double tent2 = (sun.texel_rad * sun.texel_rad + across * across) / 6;
  sun.radius_rad = std::sqrt(2 * (std::max(2 * (1 - length / weight), 0.0) + tent2));
}

// Of the whole image on a surface that faces a direction.
double illuminance_from(const Texels& texels, glm::dvec3 direction) {
  std::vector<double> rows(size_t(texels.height()));
  tbb::parallel_for(0, texels.height(), [&](int y) {
    double sum = 0;
    for (int x = 0; x < texels.width(); ++x)
      sum += std::max(glm::dot(texels.direction(x, y), direction), 0.0) * luminance(texels.at(x, y));
    rows[size_t(y)] = sum * texels.solid_angle(y);
  });
  double all = 0;
  for (const double row : rows) all += row;
  return all;
}

}  // namespace

bool SkySun::is_narrow() const {
  return contrast >= least_contrast_asked_for &&
         radius_rad <= std::clamp(most_radius_texels * texel_rad, most_radius_rad, widest_rad);
}
bool SkySun::is_sun() const { return is_narrow() && share >= least_share && contrast >= least_contrast; }

std::optional<SkySun> find_sun(const DecodedImage& image) {
  const Texels texels(image);
  SkySun sun;
  sun.texel_rad = texels.row_rad();
  sun.direction = brightest(texels);
  if (sun.direction == glm::dvec3(0)) return {};
  const double widest = std::max(search_rad, search_texels * sun.texel_rad);
  // First within the widest reach, whose middle is found from the brightest texel; then as far as the spot goes.
  sun.reach_rad = widest;
  for (int i = 0; i < 3; ++i) measure(texels, sun);
  sun.reach_rad = std::min(std::max(reach_radii * sun.radius_rad, reach_texels * sun.texel_rad), widest);
  measure(texels, sun);
  const double own = luminance(sun.illuminance);
  if (!(own > 0)) return {};
  const double solid_angle = 2 * pi * (1 - std::cos(sun.radius_rad)), around = luminance(sun.around);
  sun.contrast = around > 0 ? own / solid_angle / around : std::numeric_limits<double>::infinity();
  sun.share = std::min(own / illuminance_from(texels, sun.direction), 1.0);
  return sun;
}

std::vector<SkyTexelBefore> take_sun(DecodedImage& image, SkySun& sun) {
  const Texels texels(image);
  const glm::vec3 around(sun.around);
  std::vector<SkyTexelBefore> before;
  glm::dvec3 lost(0);
  texels.about(sun.direction, sun.reach_rad, [&](int x, int y, glm::dvec3) {
    const glm::vec3 was(texels.at(x, y)), left = glm::min(was, around);
    if (was == left) return;
    before.push_back({texels.place(x, y), was});
    lost += texels.solid_angle(y) * glm::dvec3(was - left);
    std::memcpy(image.pixels.data() + size_t(texels.place(x, y)) * 16, &left, 12);
  });
  sun.illuminance = lost;
  return before;
}

}  // namespace candela
