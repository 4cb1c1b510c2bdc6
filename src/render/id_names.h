#pragma once
#include <string>
#include <vector>

#include "image/image.h"
#include "scene/scene.h"

namespace candela {

// For a plane of layer object_id or material_id: an attribute candela:LAYER with the names (scene/matte_names.h) of the
// ids in the picture, as JSON, {"3":"Box","7":"Box #7"}. Any other layer: nothing.
void add_id_names(std::vector<MetadataEntry>& metadata, const Scene& scene, const PlaneView& plane, int width,
                  int height);
void add_id_names(FloatImage& image, const Scene& scene);  // of all its planes

}  // namespace candela
