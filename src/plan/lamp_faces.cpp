#include "plan/lamp_faces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "plan/sun_cascades.h"

namespace candela {
namespace {

// Wider cones are drawn as cubes: texels at the edge of one map would be seen ever more aslant.
constexpr double widest_map_rad = 65 * 3.14159265358979323846 / 180;
// Between the axis of a cube's face and its corners, and some more.
constexpr double face_corner_rad = 0.9554 + 0.15;

// Texels at each side of a map: half of what a lookup reads, and half a texel for rounding.
constexpr double border_texels = double(shared::lamp_kernel_texels) + 0.5;

}  // namespace

bool Lamp::is_cube() const { return !(cone_rad > 0 && cone_rad <= widest_map_rad); }

Lamp lamp_of(const LightItem& light) {
  Lamp lamp;
  lamp.position = glm::dvec3(light.position);
  lamp.world_position = light.world_position;
  lamp.range_m = double(light.range_m);
  if (light.type == LightType::spot) {
    lamp.direction = glm::normalize(glm::dvec3(light.direction));
    lamp.cone_rad = std::max(double(light.outer_cone_rad), 1e-3);
  }
  return lamp;
}

LampAxes lamp_axes(const Lamp& lamp, int face) {
  if (!lamp.is_cube()) {
    const glm::dmat3 axes = light_axes(lamp.direction);
    return {axes[0], axes[1], lamp.direction};
  }
  const int axis = face / 2;
  LampAxes axes{glm::dvec3(0), glm::dvec3(0), glm::dvec3(0)};
  axes.right[(axis + 1) % 3] = axes.up[(axis + 2) % 3] = 1;
  axes.forward[axis] = face % 2 ? -1 : 1;
  return axes;
}

double lamp_tangent(const Lamp& lamp, uint32_t size_px) {
  return (lamp.is_cube() ? 1 : std::tan(lamp.cone_rad)) * size_px / (size_px - 2 * border_texels);
}

bool lamp_face_is_seen(const Lamp& lamp, int face, uint32_t size_px, const FrustumPlanes& view) {
  const LampAxes axes = lamp_axes(lamp, face);
  if (lamp.is_cube() && lamp.cone_rad > 0 &&
      glm::dot(axes.forward, lamp.direction) < std::cos(std::min(lamp.cone_rad + face_corner_rad, 3.14159)))
    return false;
  const double tangent = lamp_tangent(lamp, size_px);
  return std::ranges::none_of(view, [&](const glm::dvec4& plane) {
    const glm::dvec3 n(plane);
    const double apex = glm::dot(n, lamp.position) + plane.w;
    if (apex >= 0) return false;
    // The pyramid's edge that leads farthest inwards.
    const double inwards =
        glm::dot(n, axes.forward) + tangent * (std::abs(glm::dot(n, axes.right)) + std::abs(glm::dot(n, axes.up)));
    return inwards <= 0 || apex + inwards * lamp.range_m < 0;
  });
}

uint32_t lamp_size_px(const Lamp& lamp, const View& view, int height_px, uint32_t most) {
  double pixel_m = 2 * view.tan_y / height_px;  // across what is seen, at the light or where it reaches nearest
  if (view.perspective) {
    const double away_m = glm::length(lamp.position);
    if (!(away_m > lamp.range_m)) return most;  // the camera is in its light
    pixel_m *= away_m;
  }
  const double across = 2 * lamp.range_m / pixel_m;
  if (!(across < most)) return most;
  const double side = std::exp2(std::round(std::log2(std::max(across, 1.0))));
  return uint32_t(std::clamp(side, double(least_lamp_px), double(most)));
}

uint32_t every_second_bit(uint64_t v) {
  uint32_t out = 0;
  for (uint32_t bit = 0; bit < 32; ++bit) out |= uint32_t(v >> (2 * bit) & 1u) << bit;
  return out;
}

std::pmr::vector<LampTile> pack_lamp_tiles(std::span<const uint32_t> sizes_px, uint32_t layer_px,
                                           std::pmr::memory_resource* memory) {
  std::pmr::vector<LampTile> tiles(memory);
  tiles.reserve(sizes_px.size());
  const uint64_t layer_texels = uint64_t(layer_px) * layer_px;
  uint64_t at = 0;
  for (const uint32_t size : sizes_px) {
    const uint64_t in_layer = at % layer_texels;
    tiles.push_back({{every_second_bit(in_layer), every_second_bit(in_layer >> 1)}, uint32_t(at / layer_texels)});
    at += uint64_t(size) * size;
  }
  return tiles;
}

shared::LampShadow lamp_shadow(const Lamp& lamp, uint32_t size_px, uint32_t layer_px) {
  const double tangent = lamp_tangent(lamp, size_px), texel = 2 * tangent / size_px;
  const LampAxes axes = lamp_axes(lamp, 0);
  shared::LampShadow out{};
  out.position = glm::vec3(lamp.position);
  out.form = lamp.is_cube() ? 1 : 0;
  out.right = glm::vec3(axes.right);
  out.up = glm::vec3(axes.up);
  out.forward = glm::vec3(axes.forward);
  out.texel_tangent = float(texel);
  out.most_tangent = float(tangent - (double(shared::lamp_kernel_texels) + 0.25) * texel);
  out.uv_per_texel = float(1.0 / layer_px);
  // Positions have rounding errors of their distance from the camera.
  out.bias_m = float(0x1p-20 * glm::length(lamp.position));
  for (shared::LampTilePlace& tile : out.tiles) tile = {0, -1};
  return out;
}

shared::View place_lamp_face(const Lamp& lamp, int face, uint32_t size_px, const LampTile& tile,
                             shared::LampShadow& shadow) {
  const LampAxes axes = lamp_axes(lamp, face);
  const double tangent = lamp_tangent(lamp, size_px);
  shared::View view{};
  const auto row = [&](int r, glm::dvec3 n, double w) {
    for (int c = 0; c < 3; ++c) view.clip_from_relative[c][r] = float(n[c]);
    view.clip_from_relative[3][r] = float(w);
  };
  const auto through_lamp = [&](int r, glm::dvec3 n) { row(r, n, -glm::dot(n, lamp.position)); };
  through_lamp(0, axes.right / tangent);
  through_lamp(1, axes.up / -tangent);
  row(2, glm::dvec3(0), double(shared::lamp_near_m));
  through_lamp(3, axes.forward);
  const auto side = [&](int p, glm::dvec3 across) {
    const glm::dvec3 n = glm::normalize(axes.forward * tangent + across);
    view.planes[p] = glm::vec4(glm::dvec4(n, -glm::dot(n, lamp.position)));
  };
  side(0, axes.right), side(1, -axes.right), side(2, axes.up), side(3, -axes.up);
  // What lies farther off than the light reaches darkens nothing.
  if (std::isfinite(lamp.range_m))
    view.planes[4] = glm::vec4(glm::dvec4(-axes.forward, lamp.range_m + glm::dot(axes.forward, lamp.position)));
  view.flags = shared::view_is_perspective | shared::view_of_lamp;
  view.origin_px = tile.origin_px;
  view.size_px = {size_px, size_px};
  view.layer = tile.layer;
  view.origin = glm::vec3(lamp.world_position);
  view.origin_rest = glm::vec3(lamp.world_position - glm::dvec3(view.origin));
  view.least_depth = float(double(shared::lamp_near_m) / lamp.range_m);
  move_lamp_face(face, size_px, tile, view, shadow);
  return view;
}

void move_lamp_face(int face, uint32_t size_px, const LampTile& tile, shared::View& view, shared::LampShadow& shadow) {
  view.tile_px = tile.origin_px;
  view.tile_layer = tile.layer;
  const glm::uvec2 middle = tile.origin_px + size_px / 2;
  shadow.tiles[face] = {middle.x | middle.y << 16, float(tile.layer)};
}

Hash128 lamp_face_key(const Lamp& lamp, int face, uint32_t size_px) {
  const LampAxes axes = lamp_axes(lamp, face);
  const std::array<double, 15> decides{lamp.world_position.x,
                                       lamp.world_position.y,
                                       lamp.world_position.z,
                                       axes.right.x,
                                       axes.right.y,
                                       axes.right.z,
                                       axes.up.x,
                                       axes.up.y,
                                       axes.up.z,
                                       axes.forward.x,
                                       axes.forward.y,
                                       axes.forward.z,
                                       lamp_tangent(lamp, size_px),
                                       lamp.range_m,
                                       double(size_px)};
  return hash128(std::as_bytes(std::span(decides)));
}

}  // namespace candela
