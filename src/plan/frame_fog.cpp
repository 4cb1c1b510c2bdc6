#include "plan/frame_fog.h"

#include <algorithm>
#include <cmath>

namespace candela {
namespace {

// The first slice reaches from the camera this part of how far is drawn: thinner ones would show nothing but
// themselves.
constexpr double first_slice = 1.0 / 1024;
// Behind this optical depth e^-30 (1e-13) of the light is left.
constexpr double deepest = 30;
// What floats can still multiply by themselves; beyond it is as good as at infinity.
constexpr double farthest_of_all_m = 1e15;

struct Depths {
  double nearest_m, farthest_m;
};

// Depths between which there are both fog and something that it is seen before or lit by.
Depths seen_depths(const Fog& fog, const View& view, const FrameData& data, double farthest_m) {
  const glm::dvec3 forward = -glm::dvec3(glm::transpose(view.view_from_relative)[2]);
  Depths d{0, std::isfinite(farthest_m) ? farthest_m : farthest_of_all_m};
  const double first_slice_m = first_slice * d.farthest_m;
  d.nearest_m = first_slice_m;
  for (const LightItem& light : data.lights) {
    if (light.type == LightType::directional || light.inner_m > 0) continue;
    const double depth = glm::dot(glm::dvec3(light.position), forward);
    d.farthest_m = std::max(d.farthest_m, depth + (std::isfinite(light.range_m) ? double(light.range_m) : 0.0));
  }
  const glm::dvec3 lowest = fog.lowest - view.position, highest = fog.highest - view.position;
  if (!glm::any(glm::isinf(lowest)) && !glm::any(glm::isinf(highest))) {
    double nearest = farthest_of_all_m, farthest = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 at((corner & 1) ? highest.x : lowest.x, (corner & 2) ? highest.y : lowest.y,
                          (corner & 4) ? highest.z : lowest.z);
      nearest = std::min(nearest, glm::dot(at, forward));
      farthest = std::max(farthest, glm::dot(at, forward));
    }
    d.nearest_m = std::max(d.nearest_m, nearest);
    d.farthest_m = std::min(d.farthest_m, farthest);
  }
  double thinnest = std::numeric_limits<double>::infinity(), thickest = 0;
  for (int c = 0; c < 3; ++c) {
    if (!(fog.scattering_per_m[c] > 0)) continue;
    thinnest = std::min(thinnest, fog.extinction_per_m[c]);
    thickest = std::max(thickest, fog.extinction_per_m[c]);
  }
  // Dense fog ends within little: the slices lie where something is to be seen of it. Density at the eye, where it
  // changes with height.
  const double level =
      fog.falloff_per_m > 0 ? std::exp(std::min(fog.falloff_per_m * (fog.height_m - view.position.y), 80.0)) : 1;
  if (thickest * level > 0 && d.nearest_m == first_slice_m)
    d.nearest_m = std::min(d.nearest_m, 0.1 / (thickest * level));
  if (fog.falloff_per_m == 0 && std::isfinite(thinnest))
    d.farthest_m = std::min(d.farthest_m, std::max(d.nearest_m, 0.0) + deepest / thinnest);
  d.nearest_m = std::clamp(d.nearest_m, 1e-24, 1e14);
  d.farthest_m = std::clamp(d.farthest_m, 4 * d.nearest_m, farthest_of_all_m);
  return d;
}

// Of the box's corners, turned, as bounds of their own.
Fog unturned(Fog fog) {
  if (fog.turn_rad == 0) return fog;
  const glm::dvec3 middle = 0.5 * (fog.lowest + fog.highest), half = 0.5 * (fog.highest - fog.lowest);
  const double c = std::abs(std::cos(fog.turn_rad)), s = std::abs(std::sin(fog.turn_rad));
  const glm::dvec2 wide(c * half.x + s * half.z, s * half.x + c * half.z);
  fog.lowest.x = middle.x - wide.x, fog.highest.x = middle.x + wide.x;
  fog.lowest.z = middle.z - wide.y, fog.highest.z = middle.z + wide.y;
  return fog;
}

// Floats that hold no more are as good as no bound.
float held(double v) { return float(std::clamp(v, -1e30, 1e30)); }
glm::vec3 held(glm::dvec3 v) { return {held(v.x), held(v.y), held(v.z)}; }

bool is_bounded(const Fog& fog) { return !(glm::all(glm::isinf(fog.lowest)) && glm::all(glm::isinf(fog.highest))); }

shared::FogBox box_of(const Fog& fog, const View& view) {
  shared::FogBox out{};
  out.extinction = glm::vec3(fog.extinction_per_m);
  for (int c = 0; c < 3; ++c) {
    if (!(fog.extinction_per_m[c] > 0)) continue;
    out.albedo[c] = float(fog.scattering_per_m[c] / fog.extinction_per_m[c]);
    out.glow[c] = float(fog.emission_per_m[c] / fog.extinction_per_m[c]);
  }
  out.anisotropy = float(fog.anisotropy);
  out.falloff = float(fog.falloff_per_m);
  out.height = held(fog.height_m - view.position.y);
  out.lowest = held(fog.lowest - view.position);
  out.highest = held(fog.highest - view.position);
  out.turn = {std::cos(fog.turn_rad), std::sin(fog.turn_rad)};
  if (fog.turn_rad != 0) {
    const glm::dvec3 middle = 0.5 * (fog.lowest + fog.highest) - view.position;
    out.middle = {held(middle.x), held(middle.z)};
  }
  out.bounded = is_bounded(fog) ? 1 : 0;
  return out;
}

}  // namespace

shared::FogMedium frame_fog(const Look& look, const View& view, const FrameData& data, double farthest_m,
                            glm::uvec3 nodes, uint32_t sky_directions) {
  const Fog& fog = *look.fog;
  shared::FogMedium out{};
  out.extinction = glm::vec3(fog.extinction_per_m);
  out.scattering = glm::vec3(fog.scattering_per_m);
  for (int c = 0; c < 3; ++c)
    if (fog.emission_per_m[c] > 0) out.glow[c] = float(fog.emission_per_m[c] / fog.extinction_per_m[c]);
  out.anisotropy = float(fog.anisotropy);
  out.falloff = float(fog.falloff_per_m);
  out.height = held(fog.height_m - view.position.y);
  out.lowest = held(fog.lowest - view.position);
  out.highest = held(fog.highest - view.position);
  out.bounded = is_bounded(fog) ? 1 : 0;
  Depths depths = seen_depths(unturned(fog), view, data, farthest_m);
  if (summed_fog(look) > 0) {
    out.media[0] = box_of(fog, view);
    for (size_t i = 0; i < look.more_fog.size(); ++i) {
      out.media[i + 1] = box_of(look.more_fog[i], view);
      if (look.more_fog[i].extinction_per_m == glm::dvec3(0)) continue;
      const Depths of_box = seen_depths(unturned(look.more_fog[i]), view, data, farthest_m);
      depths.nearest_m = std::min(depths.nearest_m, of_box.nearest_m);
      depths.farthest_m = std::max(depths.farthest_m, of_box.farthest_m);
    }
  }
  out.nodes = nodes;
  out.nearest_m = float(depths.nearest_m);
  out.log2_ratio = float(std::log2(depths.farthest_m / depths.nearest_m) / double(std::max(nodes.z, 3u) - 2));
  out.sky_directions = sky_directions;
  return out;
}

float volumetric_reach_m(const Volumetric& look, const FrameData& data) {
  double reach = 0;
  for (const LightItem& light : data.lights)
    if (light.type != LightType::directional && !(light.inner_m > 0))
      reach = std::max(reach, double(glm::length(glm::dvec3(light.position))) + double(light.range_m));
  if (look.tau_per_m > 0) reach = std::min(reach, deepest / look.tau_per_m);
  return float(std::min(reach, farthest_of_all_m));
}

}  // namespace candela
