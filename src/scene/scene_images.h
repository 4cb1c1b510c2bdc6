#pragma once
#include <filesystem>

#include "image/io.h"
#include "scene/scene.h"

namespace candela {

// What the warnings say of an image that cannot be had.
inline constexpr const char* placeholder_note = "a magenta and black checker is drawn instead";

struct SceneTexture {
  DecodedImage image;
  std::vector<std::string> warnings;  // damaged images, each named; loading has warned of those that are missing
};
// Decodes an image of the scene; the checker where it is missing or damaged, in every renderer the same. One that
// stands for a merged pair becomes R occlusion, G roughness, B metallic, A 1: 16 bits where either has them, the larger
// width and height of the two (the smaller is resampled bilinearly). Error: out of memory.
Expected<SceneTexture> decode_scene_image(const Scene& scene, int image);

// What the meshes take and what the textures that materials use take decoded with their mips, by the heads of the
// images. Error (input): more than the budget of base/input.h; names the image with which it is exceeded.
Expected<uint64_t> decoded_bytes(const Scene& scene);

// The environment that lights the scene: read_environment() with what it takes charged on top of the scene. Warnings
// are log lines.
Expected<DecodedImage> read_sky(const std::filesystem::path& path, const Scene& scene);

}  // namespace candela
