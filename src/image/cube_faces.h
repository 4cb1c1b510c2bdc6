#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "image/io.h"

namespace candela {

// A sky of six square images: a folder that holds them, or a path whose file name has a * where the face's name goes.
// Faces are called px nx py ny pz nz, posx negx ..., right left top bottom front back, right left up down front back,
// or rt lf up dn ft bk, alone or at the end of a name. They are +X, -X, +Y, -Y, +Z, -Z, turned as Vulkan's cube maps
// are: seen from inside with +Y up, but for the two of Y, whose upper edges meet -Z (top) and +Z (bottom).
bool names_cube_faces(const std::filesystem::path& sky);
// In that order. Errors (input) name the faces that are missing.
Expected<std::array<std::filesystem::path, 6>> cube_face_files(const std::filesystem::path& sky);

// The six as an equirectangular image (scene/environment.h) with as many texels along the equator: each the mean of
// four places, read bilinearly inside a face. 8- and 16-bit images are taken as sRGB. before_bytes: as
// read_environment().
Expected<DecodedImage> read_cube_faces(const std::filesystem::path& sky, uint64_t before_bytes);

}  // namespace candela
