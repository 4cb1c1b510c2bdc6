#pragma once
#include "image/io.h"
#include "scene/scene.h"

namespace candela {
// Decodes an image of the scene. One that stands for a merged pair becomes R occlusion, G roughness, B metallic, A 1:
// 16 bits where either has them, the larger width and height of the two (the smaller is resampled bilinearly). Errors
// name the image.
Expected<DecodedImage> decode_scene_image(const Scene& scene, int image);
}  // namespace candela
