#pragma once
#include <string>
#include <vector>

#include "scene/scene.h"

namespace candela {

// Blended materials whose surfaces hide all or nothing: their alpha, by factor, texture and corners, is nowhere more
// than 1/255 from 0 or 1, and no animation moves it. Exporters write many cut-outs so, leaves and fences. Decodes the
// textures; one that cannot be read makes none.
std::vector<uint32_t> cut_out_materials(const Scene& scene);

// Makes opaque what blends by its material and hides all: the factor of its alpha is 1, its texture's image has no
// alpha, nor has a corner any but 1, and no animation moves it. Such a surface needs no order, and hides all of a
// light, so that it belongs into depth maps. Exporters write many. Returns which they were.
std::vector<uint32_t> make_covering_opaque(Scene& scene);

// How cut-outs are drawn (--cut-outs).
const std::vector<std::string>& cut_out_choices();
// blended: as the file says. masked: as masks with a cutoff of a half, which need no order, hide what is behind them
// from the depth pre-pass on and cast shadows of their shape; edges, which blending smooths over a texel, are hard.
void apply_cut_outs(Scene& scene, const std::string& choice);

}  // namespace candela
