#pragma once
#include <string>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"

namespace candela {

bool is_cryptomatte(const std::string& layer);  // crypto_object, crypto_material
// The layer's channels of one level, "crypto_object00.R" to ".A": id, coverage, id, coverage.
std::vector<std::string> matte_channels(const std::string& layer, uint32_t level);

// The attributes by which readers of Cryptomatte 1.2.0 find a layer: its name, how ids are made of names, and the
// manifest, JSON of the id of every name that the scene could show: the same in every frame.
void add_cryptomatte(std::vector<MetadataEntry>& metadata, const Scene& scene, const std::string& layer);

}  // namespace candela
