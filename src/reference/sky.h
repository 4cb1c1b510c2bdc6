#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "image/io.h"
#include "look/look.h"

namespace candela::reference {

// Light from infinitely far away: an equirectangular image, the neutral default that scenes without any light get, or
// nothing. Directions are world axes (and so relative space's).
class Sky {
 public:
  Sky() = default;  // black
  // rgba32f or rgba16f, read bilinearly: longitude wraps, the poles do not. Turned about +Y, counter-clockwise seen
  // from above, its radiance multiplied.
  explicit Sky(const DecodedImage& equirect, double turn_rad = 0, double times = 1);
  // A weighted sum of such images, all of one size, and of a gradient.
  struct Part {
    const DecodedImage* equirect = nullptr;
    glm::dvec3 weight{1};
  };
  static Sky sum(std::span<const Part> parts, const std::optional<SkyGradient>& gradient, double gradient_weight,
                 double turn_rad, double times);
  static Sky neutral();  // radiance 0.45 + 0.25 y, as scene/environment.h defines neutral_ambient()
  // scene/studio.h by its formula, turned and multiplied as images are.
  static Sky studio(double turn_rad = 0, double times = 1);
  static Sky constant(glm::dvec3 radiance);  // for tests with closed forms

  explicit operator bool() const { return kind_ != Kind::none; }
  glm::dvec3 radiance(glm::dvec3 direction) const;  // direction of unit length
  // What the background shows more of a texel, row by row, of the image; it lights nothing.
  void show(uint32_t texel, glm::dvec3 more) { shown_[texel] += more; }
  glm::dvec3 seen(glm::dvec3 direction) const;  // radiance() and that
  // What the camera sees where the background is blurred: the mean under exp(cos(angle) / deviation^2), estimated from
  // some directions about this one, other ones for each direction.
  glm::dvec3 blurred(glm::dvec3 direction, double deviation_rad) const;

  // Directions by luminance: a row by its fraction, a column by its fraction of the row, uniform in solid angle within
  // a texel (Pharr and Humphreys's piecewise-constant distribution, with densities exact per texel). pdf is per
  // steradian.
  struct Choice {
    glm::dvec3 direction{0, 1, 0};
    double pdf = 0;
  };
  Choice sample(glm::dvec2 u) const;
  double pdf(glm::dvec3 direction) const;

 private:
  enum class Kind { none, linear, image, sum, studio };
  void make_distribution(int width, int height);
  glm::dvec3 texel(int x, int y) const;
  template <class Texel>
  glm::dvec3 bilinear(glm::dvec3 direction, Texel texel) const;
  glm::dvec3 gradient_at(double sine) const;
  double solid_angle(int row) const;
  glm::ivec2 cell_of(glm::dvec3 direction) const;
  glm::dvec3 in_image(glm::dvec3 direction) const;  // from world axes to the image's

  Kind kind_ = Kind::none;
  glm::dvec3 constant_{0}, slope_{0};  // linear: radiance constant + slope * y
  double turn_cos_ = 1, turn_sin_ = 0, times_ = 1;
  int image_width_ = 0, image_height_ = 0;
  std::vector<glm::vec3> texels_;
  std::unordered_map<uint32_t, glm::dvec3> shown_;
  std::optional<SkyGradient> gradient_;
  double gradient_weight_ = 0;
  int width_ = 0, height_ = 0;                // of the distribution
  std::vector<double> row_end_, column_end_;  // cumulative; the last of each is exactly 1
};

}  // namespace candela::reference
