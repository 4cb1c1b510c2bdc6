#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

namespace candela {

// The sky a quarter of an hour after sunset, which was at -Z: radiance (linear Rec.709) from a unit direction, +Y up.
glm::dvec3 dusk_sky_radiance(glm::dvec3 direction, uint64_t seed);

// The same as an equirectangular Radiance HDR of 512 by 256 pixels.
std::vector<std::byte> make_dusk_sky(uint64_t seed);

// An equirectangular Radiance HDR, twice as wide as high, of radiance by direction.
std::vector<std::byte> radiance_hdr(int height, const std::function<glm::dvec3(glm::dvec3)>& radiance);

}  // namespace candela
