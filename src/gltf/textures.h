#pragma once
#include "gltf/document.h"
#include "scene/scene.h"

namespace candela::gltf {
void import_samplers(Document& document, Scene& scene);
// A textureInfo object, or an empty slot when there is none or its image is in a format that is not read (with a
// warning). Marks the image in `image_used`.
TextureSlot texture_slot(Document& document, const Json& object, const char* key, const std::string& path,
                         std::vector<bool>& image_used);
// Warns of images that say of their colours what their use does not (KTX2): the use decides, as for every other format.
void check_transfer(Document& document, const Scene& scene);
// One SceneImage per image of the file, with the bytes of those that are used.
void import_images(Document& document, const std::vector<bool>& image_used, Scene& scene);
}  // namespace candela::gltf
