#include "plan/sun_cascades.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/transforms.h"

namespace candela {
namespace {

bool is_finite(glm::dvec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// Slices begin no nearer than this part of how far is drawn; where that is not known, of the nearest times this.
constexpr double nearest_part = 1e-4, unknown_far = 1e5;

// Up to the next of 64 steps an octave of the unit, so that a size that drifts from frame to frame keeps its texels for
// long.
double quantised_up(double size, double unit) {
  const double units = size / unit;
  if (!(units > 0)) return 0;
  const double step = std::exp2(std::floor(std::log2(units))) / 64;
  return std::ceil(units / step * (1 - 1e-9)) * step * unit;
}

// Across and along a light, absolute: x right, y up, z towards the light.
struct LightSpace {
  glm::dmat3 axes;
  glm::dvec3 of(glm::dvec3 world) const { return glm::transpose(axes) * world; }
  DAabb of(const DAabb& relative, glm::dvec3 camera) const {
    DAabb box = relative;
    box.min += camera, box.max += camera;
    return transformed(box, glm::dmat4(glm::transpose(axes)));
  }
};

// A square across the light and what the cascade's slice takes of the light's depths.
struct Square {
  glm::dvec2 centre{0};
  double half_m = 0;
};

// What lies in the view between two depths, as a sphere: the same whichever way the camera turns.
struct Slice {
  glm::dvec3 centre;  // world
  double radius_m;
};
Slice slice_of(const View& view, double near_m, double far_m) {
  const glm::dvec3 forward = -glm::transpose(glm::dmat3(view.view_from_relative))[2];
  const double k = std::hypot(view.tan_x, view.tan_y);
  if (!view.perspective) return {view.position + forward * ((near_m + far_m) / 2), std::hypot(k, (far_m - near_m) / 2)};
  const SliceSphere sphere = slice_sphere(near_m, far_m, k);
  return {view.position + forward * sphere.depth_m, sphere.radius_m};
}

DAabb corner_box(const LightSpace& light, const View& view, double near_m, double far_m) {
  const glm::dmat3 axes = glm::transpose(glm::dmat3(view.view_from_relative));  // right, up, back
  DAabb box;
  for (const double depth : {near_m, far_m})
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) {
        const double wide = view.perspective ? depth : 1;
        box.add(light.of(view.position + axes * glm::dvec3(x * view.tan_x * wide, y * view.tan_y * wide, -depth)));
      }
  return box;
}

// The square, no larger than what is drawn: beyond that there is nothing to cast or receive.
Square clipped(Square square, const DAabb& drawn) {
  const glm::dvec2 low(drawn.min), high(drawn.max);
  const double least_m = std::isfinite(square.half_m) ? 1e-6 * square.half_m : 1e-30;
  if (!is_finite(drawn.min) || !is_finite(drawn.max)) return square;
  const double half_m = std::max({high.x - low.x, high.y - low.y, least_m}) / 2 * (1 + 1e-6);
  if (half_m >= square.half_m) return square;
  return {(low + high) / 2.0, half_m};
}

shared::View cascade_view(const glm::dmat3& axes, glm::dvec2 centre, double half_m, glm::dvec4 depth,
                          const Square* served, uint32_t layer, uint32_t size_px, float least_texels) {
  shared::View view{};
  const glm::dvec3 x = axes[0] / half_m, y = axes[1] / -half_m;
  glm::dmat4 clip(0);
  for (int c = 0; c < 3; ++c) clip[c] = {x[c], y[c], depth[c], 0};
  clip[3] = {-centre.x / half_m, centre.y / half_m, depth.w, 1};
  view.clip_from_relative = glm::mat4(clip);
  const auto set = [&](glm::vec4& plane, glm::dvec3 normal, double w) { plane = glm::vec4(glm::dvec4(normal, w)); };
  const auto set_square = [&](glm::vec4* planes, glm::dvec2 c, double half) {
    set(planes[0], axes[0], half - c.x), set(planes[1], -axes[0], half + c.x);
    set(planes[2], axes[1], half - c.y), set(planes[3], -axes[1], half + c.y);
  };
  set_square(view.planes, centre, half_m);
  // What lies behind the receivers darkens none. Nothing is cut on the light's side: it is flattened onto the near
  // plane.
  const double length = glm::length(glm::dvec3(depth));
  set(view.planes[4], glm::dvec3(depth) / length, depth.w / length);
  if (served && served->half_m > 0) {
    set_square(view.served, served->centre, served->half_m);
    view.flags |= shared::view_has_served;
  }
  view.least_px = least_texels;
  view.size_px = {size_px, size_px};
  view.layer = layer;
  return view;
}

}  // namespace

std::pmr::vector<double> cascade_splits(double near_m, double far_m, int count, double lambda,
                                        std::pmr::memory_resource* memory) {
  std::pmr::vector<double> ends(memory);
  for (int i = 1; i <= count; ++i) {
    const double fraction = double(i) / count;
    const double logarithmic = near_m * std::pow(far_m / near_m, fraction),
                 uniform = near_m + (far_m - near_m) * fraction;
    ends.push_back(i == count ? far_m : lambda * logarithmic + (1 - lambda) * uniform);
  }
  return ends;
}

SliceSphere slice_sphere(double near_m, double far_m, double k) {
  const double depth_m = std::min(far_m, (near_m + far_m) / 2 * (1 + k * k));
  // The far corners lie on it; the near ones too unless the far disc decides alone.
  return {depth_m, std::hypot(far_m - depth_m, k * far_m)};
}

glm::dmat3 light_axes(glm::dvec3 direction) {
  const glm::dvec3 n = -direction;
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {glm::dvec3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x), glm::dvec3(b, sign + n.y * n.y * a, -n.y), n};
}

SunCascades fit_sun_cascades(glm::dvec3 direction, const View& view, const SunFit& fit, const SunKnobs& knobs,
                             uint32_t first_layer, std::pmr::memory_resource* memory) {
  const bool single = SunMode(knobs.mode) == SunMode::single;
  const LightSpace light{light_axes(direction)};
  const glm::dvec3 camera = light.of(view.position);
  const DAabb drawn = light.of(fit.drawn_relative, view.position);
  const bool is_bounded = is_finite(drawn.min) && is_finite(drawn.max);
  const int count = single ? 1 : knobs.cascades;
  const uint32_t size_px = std::min(uint32_t(single ? knobs.single_px : knobs.size_px), fit.most_px);

  // Depths of the view that are divided. What is drawn beyond that part of them is left to the last cascade.
  const bool knows_depth = std::isfinite(fit.farthest_m) && fit.farthest_m > 0;
  const double unit = fit.scene_size_m > 0 ? fit.scene_size_m : 1;
  const double least_near_m = std::max(view.near_m, 1e-30);
  const double drawn_far_m = knows_depth ? quantised_up(fit.farthest_m * (1 + 1e-6), unit) : unknown_far * least_near_m;
  const double near_m =
      std::max({least_near_m, nearest_part * drawn_far_m, knows_depth ? quantised_up(fit.nearest_m, unit) / 2 : 0.0});
  const double far_m = std::max(drawn_far_m, 2 * near_m);
  const double split_far_m = std::clamp(double(knobs.distance) * far_m, 2 * near_m, far_m);
  std::pmr::vector<double> ends = cascade_splits(near_m, split_far_m, count, double(knobs.split_lambda), memory);
  ends.back() = far_m;

  // All cascades share the light's depths of everything that can receive: a caster's shadow never leaves its square.
  const Slice all = slice_of(view, near_m, far_m);
  double low = light.of(all.centre).z - all.radius_m, high = low + 2 * all.radius_m;
  if (is_bounded) {
    // Casters before the receivers are flattened onto the near plane, unless there is depth to spare for them.
    low = std::max(low, drawn.min.z);
    high = drawn.max.z - low < 4 * (high - low) ? drawn.max.z : std::min(high, drawn.max.z);
    if (single) low = drawn.min.z, high = drawn.max.z;
  }
  const double slack = std::max((high - low) * 1e-3, 1e-6 * far_m);
  low -= slack;
  high = std::max(high, low) + slack;
  const double range_m = high - low;
  const glm::dvec4 depth(light.axes[2] / range_m, (camera.z - low) / range_m);

  SunCascades out{.views = std::pmr::vector<shared::View>(memory)};
  out.shadow.right = glm::vec3(light.axes[0]);
  out.shadow.up = glm::vec3(light.axes[1]);
  out.shadow.depth = glm::vec4(depth);
  out.shadow.to_light = glm::vec3(light.axes[2]);
  // Positions have rounding errors of their distance from the camera, depths of their range.
  out.shadow.bias = float(0x1p-20 * (range_m + far_m) / range_m);
  out.shadow.cascade_count = uint32_t(count);
  out.shadow.first_layer = first_layer;
  // The lookup of a covered point stays inside of the map, after the map's own shift by up to a texel.
  const double border_texels = lookup_reach_texels + 1, grown = size_px / (size_px - 2 * (border_texels + 1));
  Square finer;
  double finer_covered_m = 0;
  for (int i = 0; i < count; ++i) {
    Square square;
    const double begin_m = i ? ends[size_t(i) - 1] : 0;  // the first holds all that is nearer, too
    if (single && is_bounded) {
      square.half_m = std::numeric_limits<double>::infinity();
    } else if (knobs.tight) {
      const DAabb box = corner_box(light, view, begin_m, ends[size_t(i)]);
      square = {glm::dvec2(box.centre()), std::max(box.extent().x, box.extent().y)};
    } else {
      const Slice slice = slice_of(view, begin_m, ends[size_t(i)]);
      square = {glm::dvec2(light.of(slice.centre)), slice.radius_m};
    }
    square = clipped(square, drawn);
    const double half_m = quantised_up(square.half_m * grown, unit), texel_m = 2 * half_m / size_px;
    square = {glm::floor(square.centre / texel_m) * texel_m, half_m};
    const glm::dvec2 centre = square.centre - glm::dvec2(camera);
    const double covered_m = half_m - border_texels * texel_m;
    Square served{finer.centre, finer_covered_m - (lookup_reach_texels + 1) * texel_m};
    out.views.push_back(cascade_view(light.axes, centre, half_m, depth, i && knobs.skip_served ? &served : nullptr,
                                     first_layer + uint32_t(i), size_px, knobs.least_texels));
    out.shadow.cascades[i] = {glm::vec2(centre), float(half_m), float(covered_m), float(texel_m)};
    finer = {centre, half_m};
    finer_covered_m = covered_m;
  }
  return out;
}

}  // namespace candela
