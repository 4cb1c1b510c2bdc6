#include "scene/studio.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "scene/environment.h"

namespace candela {
namespace {

constexpr double degree = std::numbers::pi / 180;

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

struct SoftBox {
  double azimuth_deg, elevation_deg;       // of its axis: from +Z towards +X, and up
  double half_width_deg, half_height_deg;  // where half of its radiance is left
  double edge_deg;                         // over which it falls off
  double radiance;
};
constexpr std::array boxes = {
    SoftBox{-28, 48, 34, 20, 5, 5.8},  // key: above and in front
    SoftBox{-88, 18, 9, 42, 4, 4.5},   // tall strips at the sides
    SoftBox{88, 18, 9, 42, 4, 4.5},    //
    SoftBox{180, 38, 30, 11, 4, 5.5},  // behind: rims
    SoftBox{20, -22, 36, 14, 5, 0.9},  // fill: low and weak
};

struct PlacedBox {
  glm::dvec3 axis, right, up;
  // Edges as tangents of the angles from the axis.
  double inner_x, outer_x, inner_y, outer_y, radiance;
};
std::array<PlacedBox, boxes.size()> placed_boxes() {
  std::array<PlacedBox, boxes.size()> placed;
  for (size_t i = 0; i < boxes.size(); ++i) {
    const SoftBox& box = boxes[i];
    const double azimuth = box.azimuth_deg * degree, elevation = box.elevation_deg * degree;
    PlacedBox& p = placed[i];
    p.axis = {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
    p.right = {std::cos(azimuth), 0, -std::sin(azimuth)};
    p.up = glm::cross(p.axis, p.right);
    const auto tangent = [](double angle_deg) { return std::tan(angle_deg * degree); };
    p.inner_x = tangent(box.half_width_deg - box.edge_deg / 2),
    p.outer_x = tangent(box.half_width_deg + box.edge_deg / 2);
    p.inner_y = tangent(box.half_height_deg - box.edge_deg / 2),
    p.outer_y = tangent(box.half_height_deg + box.edge_deg / 2);
    p.radiance = box.radiance;
  }
  return placed;
}

// From floor to horizon within some degrees, then slowly to the ceiling.
double behind_boxes(double sine) {
  constexpr double floor = 0.03, horizon = 0.12, ceiling = 0.3;
  return floor + (horizon - floor) * smoothstep(-0.25, 0.03, sine) + (ceiling - horizon) * std::max(sine, 0.0);
}

}  // namespace

double studio_radiance(glm::dvec3 d) {
  static const auto placed = placed_boxes();
  double sum = behind_boxes(d.y);
  for (const PlacedBox& box : placed) {
    const double along = glm::dot(d, box.axis);
    if (along <= 0) continue;
    const double x = std::abs(glm::dot(d, box.right)) / along, y = std::abs(glm::dot(d, box.up)) / along;
    sum += box.radiance * (1 - smoothstep(box.inner_x, box.outer_x, x)) * (1 - smoothstep(box.inner_y, box.outer_y, y));
  }
  return sum;
}

DecodedImage studio_image(int width, int height) {
  DecodedImage image{width, height, DecodedImage::Format::rgba32f, 3, {}};
  image.pixels.resize(size_t(width) * size_t(height) * 16);
  constexpr int parts = 2;  // each way
  // Directions of one row are turned copies of its first: columns hold the turns.
  std::vector<glm::dvec3> turns;
  for (int x = 0; x < width * parts; ++x) turns.push_back(equirect_direction((x + 0.5) / (width * parts), 0.5));
  tbb::parallel_for(0, height, [&](int y) {
    std::vector<double> sums(static_cast<size_t>(width));
    double weights = 0;
    for (int j = 0; j < parts; ++j) {
      const glm::dvec3 up = equirect_direction(0.5, (y + (j + 0.5) / parts) / height);
      const double across = std::hypot(up.x, up.z);  // the sine of the polar angle is the row's fraction, too
      weights += parts * across;
      for (int x = 0; x < width * parts; ++x) {
        const glm::dvec3& turn = turns[size_t(x)];
        sums[size_t(x / parts)] += across * studio_radiance({across * turn.x, up.y, across * turn.z});
      }
    }
    for (int x = 0; x < width; ++x) {
      const float mean = float(sums[size_t(x)] / weights);
      const glm::vec4 texel(mean, mean, mean, 1);
      std::memcpy(image.pixels.data() + (size_t(y) * size_t(width) + size_t(x)) * 16, &texel, 16);
    }
  });
  return image;
}

}  // namespace candela
