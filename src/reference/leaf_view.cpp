#include "reference/leaf_view.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace candela::reference {
namespace {

bool crosses(const CameraRay& ray, const Aabb& box) {
  double near = ray.t_min, far = ray.t_max;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = double(box.min[axis]) - ray.origin[axis], high = double(box.max[axis]) - ray.origin[axis];
    if (ray.direction[axis] == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double a = low / ray.direction[axis], b = high / ray.direction[axis];
    near = std::max(near, std::min(a, b)), far = std::min(far, std::max(a, b));
  }
  return near <= far;
}

// Pixels whose lines of sight may cross a box; all of them where it reaches behind the camera.
struct PixelRange {
  int left = 0, top = 0, right = -1, bottom = -1;
};
PixelRange pixels_of(const Aabb& box, const View& view, int width, int height) {
  glm::dvec2 low(1e30), high(-1e30);
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec4 p(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                       corner & 4 ? box.max.z : box.min.z, 1);
    const glm::dvec4 clip = view.clip_from_relative * p;
    if (!(clip.w > 0) || (view.perspective && clip.w < view.near_m)) return {0, 0, width - 1, height - 1};
    const glm::dvec2 pixel = (glm::dvec2(clip) / clip.w * 0.5 + 0.5) * glm::dvec2(width, height);
    low = glm::min(low, pixel), high = glm::max(high, pixel);
  }
  return {int(std::clamp(std::floor(low.x) - 1, 0.0, double(width))),
          int(std::clamp(std::floor(low.y) - 1, 0.0, double(height))), int(std::clamp(high.x + 1, -1.0, width - 1.0)),
          int(std::clamp(high.y + 1, -1.0, height - 1.0))};
}

}  // namespace

std::vector<float> leaf_counts(const World& world, const Film& film) {
  const int width = film.picture().x, height = film.picture().y;
  std::vector<float> counts(film.pixels());
  const std::vector<LeafBox> leaves = world.accel().leaves();
  std::vector<PixelRange> ranges(leaves.size());
  tbb::parallel_for(size_t(0), leaves.size(),
                    [&](size_t i) { ranges[i] = pixels_of(leaves[i].box, world.view(), width, height); });
  const int left = film.corner().x, top = film.corner().y;
  tbb::parallel_for(top, top + film.height(), [&](int y) {
    for (size_t i = 0; i < leaves.size(); ++i) {
      if (y < ranges[i].top || y > ranges[i].bottom) continue;
      for (int x = std::max(ranges[i].left, left); x <= std::min(ranges[i].right, left + film.width() - 1); ++x)
        if (crosses(world.camera_ray(glm::dvec2(x + 0.5, y + 0.5), width, height), leaves[i].box))
          counts[size_t(y - top) * size_t(film.width()) + size_t(x - left)] += 1;
    }
  });
  return counts;
}

}  // namespace candela::reference
