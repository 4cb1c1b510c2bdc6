#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "image/io.h"

namespace candela {

// The spot of a sky's image that gives most light: a disc, in the image's own axes.
struct SkySun {
  glm::dvec3 direction{0, 1, 0};  // unit, towards its middle
  glm::dvec3 illuminance{0};      // of what it is brighter than its surroundings by, on a surface that faces it
  glm::dvec3 around{0};           // mean radiance of the surroundings
  double reach_rad = 0;           // from its middle, of what is taken
  double radius_rad = 0;          // of the disc of as much spread about its middle
  double texel_rad = 0;           // height of the image's texels
  double share = 0;               // of the light on a surface that faces it
  double contrast = 0;            // of the disc's radiance to that of the surroundings; infinite before black
  bool is_narrow() const;         // enough for a directional light
  bool is_sun() const;            // narrow, and of so much light and contrast that its shadows are seen
};

// Absent where the image is black, or even.
std::optional<SkySun> find_sun(const DecodedImage& sky);

// A texel of the image as it was.
struct SkyTexelBefore {
  uint32_t place;
  glm::vec3 radiance;
};
// Takes the spot out: no channel of its texels is brighter than the surroundings' mean. Its illuminance becomes exactly
// what the texels lose. Returns them as they were.
std::vector<SkyTexelBefore> take_sun(DecodedImage& sky, SkySun& sun);

}  // namespace candela
