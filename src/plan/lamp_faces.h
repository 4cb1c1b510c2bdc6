#pragma once
#include <glm/glm.hpp>
#include <memory_resource>
#include <span>
#include <vector>

#include "base/hash.h"
#include "math/bounds.h"
#include "scene/frame_data.h"
#include "scene/view.h"
#include "shared/cull.h"
#include "shared/shadows.h"

namespace candela {

// A point or spot light with shadow maps, in relative space. Every map is a square perspective view from the light with
// reversed infinite depth: one down the cone of a narrow spot, else the six faces of a cube with the world's axes.
struct Lamp {
  glm::dvec3 position{0};
  glm::dvec3 direction{0, 0, -1};  // of a spot, unit
  double cone_rad = 0;             // its half angle; 0: it shines all round
  double range_m = 0;              // infinity: none
  glm::dvec3 world_position{0};
  bool is_cube() const;
  int faces() const { return is_cube() ? 6 : 1; }
};
Lamp lamp_of(const LightItem& light);

// A map's axes: what lies in it has positive `forward`. Of a cube's: 0 +x, 1 -x, 2 +y, ...
struct LampAxes {
  glm::dvec3 right, up, forward;
};
LampAxes lamp_axes(const Lamp& lamp, int face);

// Tangent of a map's half angle: the cone's or 45 degrees, and a border that no lookup leaves.
double lamp_tangent(const Lamp& lamp, uint32_t size_px);

// Whether what a map holds can be of use: its pyramid, as far as the light reaches, touches the view, and the cone.
bool lamp_face_is_seen(const Lamp& lamp, int face, uint32_t size_px, const FrustumPlanes& view);

// Texels along a side of a light's maps: as many as make a texel of what lies as far from the light as it reaches about
// a pixel wide, in powers of two from least_lamp_px to `most`.
uint32_t lamp_size_px(const Lamp& lamp, const View& view, int height_px, uint32_t most);
inline constexpr uint32_t least_lamp_px = 64;

// Places squares whose sides are powers of two, the largest first, one after the other along a Z-order curve, layer by
// layer: without gaps, for each begins at a multiple of its own area (Morton, "A Computer Oriented Geodetic Data Base",
// 1966).
struct LampTile {
  glm::uvec2 origin_px{0};
  uint32_t layer = 0;
};
uint32_t every_second_bit(uint64_t v);  // from the least one on: a place along such a curve gives x, half of it y
std::pmr::vector<LampTile> pack_lamp_tiles(std::span<const uint32_t> sizes_px, uint32_t layer_px,
                                           std::pmr::memory_resource* memory = std::pmr::get_default_resource());

// What surfaces read of a light, as yet without maps, and the view that draws one into its tile, which it makes known.
shared::LampShadow lamp_shadow(const Lamp& lamp, uint32_t size_px, uint32_t layer_px);
shared::View place_lamp_face(const Lamp& lamp, int face, uint32_t size_px, const LampTile& tile,
                             shared::LampShadow& shadow);
// Where the map is read, if that is not where it is drawn.
void move_lamp_face(int face, uint32_t size_px, const LampTile& tile, shared::View& view, shared::LampShadow& shadow);

// A hash of what decides the map's texels beside what casts into it, in the world: wherever the camera is.
Hash128 lamp_face_key(const Lamp& lamp, int face, uint32_t size_px);

}  // namespace candela
